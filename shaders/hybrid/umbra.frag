#version 460
// A pixel whose ray was blocked.
layout(location = 0) out float visibility;
void main() { visibility = 0.0; }
