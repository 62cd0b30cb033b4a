#version 460
// A pixel that no light reaches.
layout(location = 0) out float visibility;
void main() { visibility = 0.0; }
