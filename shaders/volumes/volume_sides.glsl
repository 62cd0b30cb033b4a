// Indices of a volume that the device appends to `uint list[]`: commands first, a VkDrawIndexedIndirectCommand each, then
// indices as volume.vert has them. Their order is the device's; nothing depends on it.
const uint COMMAND_WORDS = 5u;

// But for the count, which is 0 already. @param command its place in the list
void beginCommand(uint command, uint firstIndex)
{
    list[command + 1u] = 1u;
    list[command + 2u] = firstIndex;
    list[command + 3u] = 0u;
    list[command + 4u] = 0u;
}

// An edge as often as its signed multiplicity says, writeSides() of algorithms/volumes/silhouette.cpp. @param halves 2
// for closed meshes, else 1
void appendSides(uint command, uint firstIndex, uint v0, uint v1, int multiplicity, uint halves)
{
    if (multiplicity == 0) return;
    uint times = min(uint(abs(multiplicity)) / max(halves, 1u), uint(list.length()));
    uint a = 2u * (multiplicity > 0 ? v0 : v1), b = 2u * (multiplicity > 0 ? v1 : v0);
    uint next = firstIndex + atomicAdd(list[command], 6u * times);
    for (uint i = 0u; i < times; ++i, next += 6u) { // bound: list
        list[next] = a;
        list[next + 1u] = a + 1u;
        list[next + 2u] = b + 1u;
        list[next + 3u] = a;
        list[next + 4u] = b + 1u;
        list[next + 5u] = b;
    }
}
