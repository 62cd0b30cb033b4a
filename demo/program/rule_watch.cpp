#include "demo/program/rule_watch.hpp"

#include <cstdio>

#include "demo/io/file.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

RuleWatch::RuleWatch(const std::string& rules)
{
    std::error_code none;
    const auto [base, preset] = splitPreset(rules);
    if (!base.empty() && std::filesystem::is_regular_file(base, none)) file_ = base;
    preset_ = preset;
    seen_ = modified();
}

std::optional<std::filesystem::file_time_type> RuleWatch::modified() const
{
    if (file_.empty()) return std::nullopt;
    std::error_code error; // no time: it is not there, or not for us
    const auto time = std::filesystem::last_write_time(file_, error);
    if (error) return std::nullopt;
    return time;
}

void RuleWatch::say(const std::string& fault)
{
    std::fprintf(stderr, "rules: %s\nrules: the last good ones stay in force\n", fault.c_str());
    fault_ = fault;
}

std::optional<std::string> RuleWatch::poll(ShadowHost& shadows, const std::function<void()>& beforeLoad)
{
    if (file_.empty() || Clock::now() < next_) return std::nullopt;
    next_ = Clock::now() + std::chrono::milliseconds(500);
    const auto time = modified();
    if (!time) {
        if (++missing_ == 2) say(file_.string() + ": cannot be read"); // at one look an editor may be replacing it
        return std::nullopt;
    }
    missing_ = 0;
    if (time == seen_) return std::nullopt;
    Outcome<std::string> text = readText(file_);
    if (!text) {
        if (time != failed_) say(text.error());
        failed_ = time;
        return std::nullopt;
    }
    seen_ = time;
    if (beforeLoad) beforeLoad();
    if (const Status loaded = shadows.loadRules(*text, file_.string(), preset_); !loaded) {
        say(loaded.error());
        return std::nullopt;
    }
    fault_.clear();
    std::printf("rules: %s is in force\n", file_.c_str());
    std::fflush(stdout);
    return std::move(*text);
}

} // namespace gnomon::demo
