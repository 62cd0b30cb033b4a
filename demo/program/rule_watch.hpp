#pragma once
// Rules edited while the scene runs: the file is read again when it changes. A bad file leaves the last good rules in
// force and says so.

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "demo/host/shadow_host.hpp"

namespace gnomon::demo {

class RuleWatch {
public:
    /// Before the rules are read for the first time: what changes from here on is loaded. \param rules as findRules()
    /// takes it; a shipped base's name or an empty text is not watched.
    explicit RuleWatch(const std::string& rules);

    /// Between frames; looks at the file twice a second at most. Prints what happened. A file that cannot be read, or
    /// is no longer there, is said once and tried again. \return the text of rules that have just come into force.
    std::optional<std::string> poll(ShadowHost& shadows, const std::function<void()>& beforeLoad = {});

    /// What was said to be wrong with the file; empty again when its rules are in force.
    const std::string& fault() const noexcept { return fault_; }

private:
    using Clock = std::chrono::steady_clock;
    std::optional<std::filesystem::file_time_type> modified() const;
    void say(const std::string& fault);

    std::filesystem::path file_;
    std::string preset_;
    std::optional<std::filesystem::file_time_type> seen_;   ///< Of the text that was read last.
    std::optional<std::filesystem::file_time_type> failed_; ///< Of the one that could not be.
    uint32_t missing_ = 0;                                  ///< Looks in a row at which it was not there.
    std::string fault_;
    Clock::time_point next_{};
};

} // namespace gnomon::demo
