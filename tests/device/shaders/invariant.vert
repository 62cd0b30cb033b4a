#version 460
// What Mesa 22 warns of: a member of a block that is invariant.
invariant gl_Position;

void main()
{
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
