#version 460
// What the points of a list show.
layout(location = 0) flat in float shown;
layout(location = 0) out float visibility;
void main() { visibility = shown; }
