#pragma once
#include <mutex>
#include <string>

#include "runtime/base/result.hpp"

namespace gnomon {

/// Where messages go: the host's callback, if any. Safe from several threads.
class Messages {
public:
    /// @param name  of the context, which comes before every text; null: none
    Messages(PFN_gnMessage callback, void* userData, const char* name = nullptr)
        : callback_(callback), userData_(userData), prefix_(name ? std::string(name) + ": " : std::string())
    {
    }

    void send(GnSeverity severity, GnResult result, const char* id, const std::string& text) const;
    void warn(const char* id, const std::string& text) const { send(GN_SEVERITY_WARNING, GN_SUCCESS, id, text); }
    void info(const char* id, const std::string& text) const { send(GN_SEVERITY_INFO, GN_SUCCESS, id, text); }
    void error(const Error& error) const { send(GN_SEVERITY_ERROR, error.result, error.id, error.text); }

private:
    PFN_gnMessage callback_;
    void* userData_;
    std::string prefix_;
};

} // namespace gnomon
