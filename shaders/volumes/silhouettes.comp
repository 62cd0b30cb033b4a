#version 460
#extension GL_GOOGLE_include_directive : require
// Sides of shadow volumes: findSilhouette() and writeSides() of algorithms/volumes/silhouette.cpp, an edge each. The
// order of the sides is the device's; nothing depends on it.
#include "../shared/face_light.h"
#include "silhouettes.h"

layout(local_size_x = 64) in; // SILHOUETTE_GROUP

layout(set = 0, binding = 0, std430) readonly buffer Topology { uint words[]; };
layout(set = 0, binding = 1, std430) readonly buffer Lights { FaceLight lights[]; }; // by piece
layout(set = 0, binding = 2, std430) buffer List { uint list[]; };              // a command per piece, then indices
layout(push_constant, std430) uniform Push { SilhouettePush push; };

#include "volume_sides.glsl"

SilhouettePiece pieceAt(uint index)
{
    uint at = push.firstPiece + 8u * index;
    return SilhouettePiece(words[at], words[at + 1u], words[at + 2u], words[at + 3u], words[at + 4u], words[at + 5u],
                           words[at + 6u], 0u);
}

vec4 planeOf(uint planes, uint face)
{
    uint at = planes + face / SILHOUETTE_BLOCK * (4u * SILHOUETTE_BLOCK) + face % SILHOUETTE_BLOCK;
    return uintBitsToFloat(uvec4(words[at], words[at + 16u], words[at + 32u], words[at + 48u]));
}

void main()
{
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (group >= push.groups) return;
    uint index = words[group];
    SilhouettePiece piece = pieceAt(index);
    uint edge = (group - piece.firstGroup) * SILHOUETTE_GROUP + gl_LocalInvocationID.x;
    uint command = COMMAND_WORDS * index;
    if (edge == 0u) beginCommand(command, piece.firstIndex);
    if (edge >= piece.edgeCount) return;

    uint at = piece.edges + EDGE_WORDS * edge, firstUse = piece.uses + words[at + 2u];
    FaceLight light = lights[index];
    int sum = 0;
    uint uses = min(words[at + 3u], uint(words.length()));
    for (uint i = 0u; i < uses; ++i) { // bound: words
        uint use = firstUse + i;
        uint way = faceWay(planeOf(piece.planes, words[use] >> 1), light);
        sum += edgeWay(way, (words[use] & 1u) != 0u);
    }
    appendSides(command, piece.firstIndex, words[at], words[at + 1u], sum, piece.halves);
}
