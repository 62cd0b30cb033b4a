// Texels of one, two or four floats in a buffer. The includer declares `const uint CHANNELS`.
#define LOAD_TEXEL(buffer, texel) \
    (CHANNELS == 1u ? vec4(buffer[texel], 0.0, 0.0, 0.0) \
     : CHANNELS == 2u ? vec4(buffer[2u * (texel)], buffer[2u * (texel) + 1u], 0.0, 0.0) \
                      : vec4(buffer[4u * (texel)], buffer[4u * (texel) + 1u], buffer[4u * (texel) + 2u], \
                             buffer[4u * (texel) + 3u]))

#define STORE_TEXEL(buffer, texel, value) \
    { \
        uint firstChannel = CHANNELS * (texel); \
        buffer[firstChannel] = (value).x; \
        if (CHANNELS > 1u) buffer[firstChannel + 1u] = (value).y; \
        if (CHANNELS > 2u) { \
            buffer[firstChannel + 2u] = (value).z; \
            buffer[firstChannel + 3u] = (value).w; \
        } \
    }
