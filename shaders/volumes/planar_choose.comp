#version 460
#extension GL_GOOGLE_include_directive : require
// The plane that most of what the light reaches lies on: 64 of 256 tiles stand as candidates, as many vote, and the winner
// is fitted to all tiles that show it. One workgroup.
#include "planar.h"

const uint CANDIDATES = 64u; // one an invocation: the first that may stand of four; 2 % of the tiles have one with 99 %
const uint TRIES = 4u;
const uint VOTERS = 256u;
const uint LEAST_VOTES = 3u; // 1 %: any plane that is one has its shadows right
const int ROUNDS = 3;         // the first inlier set is loose, the third no longer changes
layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std140) uniform Constants { PlaneChoice choice; };
layout(set = 0, binding = 1, std430) readonly buffer Tiles { TilePlane tiles[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Plane { ReceiverPlane result; };

shared uint votes[CANDIDATES];
shared uint candidates[CANDIDATES]; // tiles
shared TilePlane fitted; // in the middle of the area
shared float sums[9 * 64];

uint tileCount() { return clamp(choice.grid.z, 1u, uint(tiles.length())); }

// Of the tile's middle, from the middle of the area.
vec2 tileMiddle(uint tile)
{
    vec2 corner = float(PLANE_TILE) * vec2(tile % max(choice.grid.x, 1u), tile / max(choice.grid.x, 1u));
    return choice.middle.zw + corner + PLANE_TILE_MIDDLE - choice.middle.xy;
}

// The i-th of tiles spread evenly, by a golden section.
uint spreadTile(uint i, float step)
{
    uint count = tileCount();
    return min(uint(fract((float(i) + 0.5) * step) * float(count)), count - 1u);
}

// Whether the light reaches what the tile shows.
bool counts(uint tile)
{
    TilePlane plane = tiles[tile];
    vec3 ray = viewRayWs(choice.view, choice.middle.xy + tileMiddle(tile));
    vec3 fromLight = choice.lightEs.w * ray / max(plane.inverse, 1e-20) - choice.lightEs.xyz;
    return plane.flatness > 0.0 && reaches(fromLight, choice.cone, choice.rangeSquared);
}

// The same plane as a single tile sees it, in the middle of the area.
TilePlane inTheMiddle(uint tile)
{
    TilePlane plane = tiles[tile];
    plane.inverse = planeInverse(plane, -tileMiddle(tile));
    return plane;
}

vec3 normalOf(TilePlane plane)
{
    return planeNormal(viewRayWs(choice.view, choice.middle.xy), choice.view.rayDxWs.xyz, choice.view.rayDyWs.xyz,
                       plane.inverse, plane.slopeX, plane.slopeY);
}

// Whether the tile shows a plane that the light falls on. The eye sees its front; so must the light.
bool mayStand(uint tile)
{
    return counts(tile) && dot(normalOf(inTheMiddle(tile)), choice.lightEs.xyz) < choice.lightEs.w;
}

void vote()
{
    uint tile = 0u;
    bool stands = false;
    for (uint i = 0u; i < TRIES && !stands; ++i) {
        tile = spreadTile(TRIES * gl_LocalInvocationIndex + i, 0.6180339887);
        stands = mayStand(tile);
    }
    TilePlane candidate = tiles[tile];
    uint count = 0u;
    for (uint i = 0u; i < VOTERS; ++i) {
        uint voter = spreadTile(i, 0.7548776662);
        bool agrees = counts(voter) && showsPlane(tiles[voter], candidate, tileMiddle(voter) - tileMiddle(tile), true);
        count += agrees ? 1u : 0u;
    }
    votes[gl_LocalInvocationIndex] = stands ? count : 0u;
    candidates[gl_LocalInvocationIndex] = tile;
}

// Sums of the normal equations for a correction of `fitted`, over the invocation's tiles. Positions in thousands of
// pixels.
void accumulate(bool loose)
{
    float sum[9] = float[9](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    uint count = tileCount();
    for (uint tile = gl_LocalInvocationIndex; tile < count; tile += 64u) { // bound: tiles
        vec2 away = tileMiddle(tile);
        TilePlane plane = tiles[tile];
        if (!counts(tile) || !showsPlane(plane, fitted, away, loose)) continue;
        float rest = plane.inverse - planeInverse(fitted, away);
        vec2 p = away * 1e-3;
        float terms[9] = float[9](1.0, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y, rest, rest * p.x, rest * p.y);
        for (int k = 0; k < 9; ++k)
            sum[k] += terms[k];
    }
    for (int k = 0; k < 9; ++k)
        sums[9 * gl_LocalInvocationIndex + k] = sum[k];
}

void correct()
{
    float sum[9] = float[9](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (int i = 0; i < 64; ++i)
        for (int k = 0; k < 9; ++k)
            sum[k] += sums[9 * i + k];
    mat3 equations = mat3(sum[0], sum[1], sum[2], sum[1], sum[3], sum[4], sum[2], sum[4], sum[5]);
    // Tiles in a line, or next to each other: what there is has to do. 1e-6 is some ten times the rounding.
    if (!(determinant(equations) > 1e-6 * sum[0] * sum[0] * sum[0])) return;
    vec3 correction = inverse(equations) * vec3(sum[6], sum[7], sum[8]);
    fitted.inverse += correction.x;
    fitted.slopeX += correction.y * 1e-3;
    fitted.slopeY += correction.z * 1e-3;
}

void main()
{
    bool leads = gl_LocalInvocationIndex == 0u;
    vote();
    barrier();
    uint best = 0u;
    for (uint i = 1u; i < CANDIDATES; ++i)
        best = votes[i] > votes[best] ? i : best;
    bool found = votes[best] >= LEAST_VOTES;
    if (leads) fitted = inTheMiddle(candidates[best]);
    for (int round = 0; round < ROUNDS; ++round) {
        barrier();
        accumulate(round == 0);
        barrier();
        if (leads) correct();
    }
    if (leads) result.normal = vec4(normalOf(fitted), found ? 1.0 : 0.0);
}
