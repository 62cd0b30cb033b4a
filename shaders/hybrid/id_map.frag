#version 460
layout(location = 0) flat in uint first;
layout(location = 0) out uint number;
void main() { number = first + uint(gl_PrimitiveID); }
