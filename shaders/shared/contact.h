// Constants of contact.frag.
#ifndef GNOMON_SHARED_CONTACT_H
#define GNOMON_SHARED_CONTACT_H
#include "receiver.h"

GN_SHARED_BEGIN

// Most places that are looked up along a ray.
GN_SHARED_CONST uint MAX_CONTACT_STEPS = 48u;

// std140.
struct ContactConstants {
    ViewConstants view;
    LightConstants light;
    vec4 area;      // pixels drawn: x, y, width, height
    float lengthWs; // of the rays, metres
    float padding0;
    float padding1;
    float padding2;
};
GN_SHARED_OFFSET(ContactConstants, area, 224)
GN_SHARED_SIZE(ContactConstants, 256)

GN_SHARED_END
#endif
