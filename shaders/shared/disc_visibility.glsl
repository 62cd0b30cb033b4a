// Percentage-closer filtering over a light's disc. The includer includes blocker_search.glsl before.

// Percentage of the disc's points whose texels do not lie before the receiver's plane; bilinear.
float discVisibility(LightCone cone, float spread, vec2 direction, uint taps)
{
    float lit = 0.0, count = float(clamp(taps, 1u, MAX_SOFT_TAPS));
    for (float i = 0.0; i < count; i += 1.0) { // bound: MAX_SOFT_TAPS
        lit += boxVisibility(cone.tap, placeOf(cone, pointRadius(i, count) * direction, spread), 1.0);
        direction = nextDirection(direction);
    }
    return lit / count;
}
