#include "demo/program/rule_watch.hpp"

#include <cstdio>

#include "demo/program/session.hpp"

namespace gnomon::demo {

RuleWatch::RuleWatch(const std::string& rules)
{
    std::error_code none;
    if (!rules.empty() && std::filesystem::is_regular_file(rules, none)) file_ = rules;
    seen_ = modified();
}

std::optional<std::filesystem::file_time_type> RuleWatch::modified() const
{
    if (file_.empty()) return std::nullopt;
    std::error_code error; // an editor may be replacing the file just now: next time, then
    const auto time = std::filesystem::last_write_time(file_, error);
    if (error) return std::nullopt;
    return time;
}

void RuleWatch::poll(ShadowHost& shadows, const std::function<void()>& beforeLoad)
{
    if (file_.empty() || Clock::now() < next_) return;
    next_ = Clock::now() + std::chrono::milliseconds(500);
    const auto time = modified();
    if (!time || time == seen_) return;
    const Outcome<std::string> text = readText(file_);
    if (!text) {
        if (time != failed_) std::fprintf(stderr, "rules: %s\n", text.error().c_str());
        failed_ = time;
        return;
    }
    seen_ = time;
    if (beforeLoad) beforeLoad();
    const Status loaded = shadows.loadRules(*text, file_.string());
    if (loaded)
        std::printf("rules: %s is in force\n", file_.c_str());
    else
        std::fprintf(stderr, "rules: %s\nrules: the last good ones stay in force\n", loaded.error().c_str());
    std::fflush(stdout);
}

} // namespace gnomon::demo
