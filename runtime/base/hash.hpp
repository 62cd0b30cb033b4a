#pragma once
// Hashes for keys and checksums; none of them resists anybody who means harm.
#include <cstdint>
#include <string_view>

namespace gnomon {

inline constexpr std::uint64_t kEmptyHash = 0xcbf29ce484222325u; ///< Of no bytes.

/// FNV-1a, of one word or byte more.
constexpr std::uint64_t hashWith(std::uint64_t hash, std::uint64_t value) noexcept
{
    return (hash ^ value) * 0x100000001b3u;
}

/// FNV-1a. @param hash of what comes before
constexpr std::uint64_t hashOfBytes(std::string_view bytes, std::uint64_t hash = kEmptyHash) noexcept
{
    for (const char c : bytes)
        hash = hashWith(hash, static_cast<unsigned char>(c));
    return hash;
}

/// Adds 64 bits to a running hash: splitmix64's finaliser over a running sum. Keys of a few thousand names collide with
/// odds below 1e-12.
constexpr std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) noexcept
{
    hash += value + 0x9e3779b97f4a7c15u;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
    return hash ^ (hash >> 31);
}

} // namespace gnomon
