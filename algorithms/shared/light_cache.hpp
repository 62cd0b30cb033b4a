#pragma once
// What a method works out for a light, found again while it is asked for.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

namespace gnomon {

/// Values by light and a key of the method's own. One thread; a value stays in place while it is asked for.
template <typename T>
class LightCache {
public:
    /// A new value where there is none.
    T& find(std::uint32_t light, std::uint32_t key)
    {
        ++asked_;
        auto found = std::ranges::find_if(
            entries_, [&](const auto& entry) { return entry->light == light && entry->key == key; });
        if (found == entries_.end()) {
            std::erase_if(entries_, [&](const auto& old) { return old->used + kForgetAfter < asked_; });
            found = entries_.insert(entries_.end(), std::make_unique<Entry>());
            (*found)->light = light;
            (*found)->key = key;
        }
        (*found)->used = asked_;
        return (*found)->value;
    }

private:
    /// What is not asked for in so many questions, some hundred frames of many lights, goes when another one comes.
    static constexpr std::uint64_t kForgetAfter = 4096;

    struct Entry {
        std::uint32_t light = 0, key = 0;
        std::uint64_t used = 0;
        T value{};
    };
    std::vector<std::unique_ptr<Entry>> entries_;
    std::uint64_t asked_ = 0;
};

} // namespace gnomon
