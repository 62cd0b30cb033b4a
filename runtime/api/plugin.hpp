#pragma once
// Algorithms registered through the C plug-in interface, and the shared objects they may come from.
#include <memory>
#include <string>
#include <vector>

#include "gnomon/algorithm.h"
#include "runtime/algorithm.hpp"

namespace gnomon {

/// An algorithm described in C, as the registry wants it. Owns copies of all names.
class PluginAlgorithm {
public:
    explicit PluginAlgorithm(const GnAlgorithmInfo& info);
    ~PluginAlgorithm();
    PluginAlgorithm(const PluginAlgorithm&) = delete;
    PluginAlgorithm& operator=(const PluginAlgorithm&) = delete;

    const AlgorithmEntry& entry() const { return entry_; }
    /// It is registered, and ours from now on: pfnDestroy is called in the end. Until then it is the host's.
    void own() { owned_ = true; }

private:
    std::string name_, source_;
    std::vector<std::string> settingNames_, settingTexts_;
    std::vector<SettingSpec> settings_;
    AlgorithmEntry entry_{};
    GnAlgorithmInfo info_;
    bool owned_ = false;
    friend class PluginShadow;
};

/// GN_ERROR_NULL_ARGUMENT, GN_ERROR_OUT_OF_RANGE, ... naming the member at fault.
Result<void> checkAlgorithmInfo(const GnAlgorithmInfo& info);

/// Closes the object when the context goes.
class SharedObject {
public:
    static Result<std::unique_ptr<SharedObject>> open(const char* path);
    ~SharedObject();
    SharedObject(const SharedObject&) = delete;
    SharedObject& operator=(const SharedObject&) = delete;
    PFN_gnPluginMain pluginMain() const { return main_; }

private:
    SharedObject() = default;
    void* handle_ = nullptr;
    PFN_gnPluginMain main_ = nullptr;
};

} // namespace gnomon
