// What both shaders of the stranger's renderer read in a frame, std140. frame_data.hpp has the same for C++.
#ifndef STRANGER_FRAME_H
#define STRANGER_FRAME_H

const int LAMP_COUNT = 6;

struct Lamp {
    vec4 positionAndRange; // world, metres
    vec4 colour;
};

layout(set = 0, binding = 0, std140) uniform Frame {
    mat4 clipFromWorld;
    vec4 eye;        // world, metres; w: near plane, metres
    vec4 viewRight;  // rows of viewFromWorld; w of the first two: clip.x / view.x and clip.y / view.y at distance 1
    vec4 viewUp;
    vec4 viewBack;
    Lamp lamps[LAMP_COUNT];
} frame;

#endif
