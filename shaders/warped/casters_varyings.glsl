// A WarpTriangle from the corners to the texels. The includer defines VARYING.
layout(location = 0) flat VARYING vec4 edge0AndLeast;
layout(location = 1) flat VARYING vec4 edge1AndGreatest;
layout(location = 2) flat VARYING vec4 edge2AndRight; // and one past the last texel to the right
layout(location = 3) flat VARYING vec4 planeAndBelow; // and below
layout(location = 4) flat VARYING vec2 base;
