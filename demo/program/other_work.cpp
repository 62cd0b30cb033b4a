#include "demo/program/other_work.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#ifdef __linux__
#include <unistd.h>
#endif

namespace gnomon::demo {
namespace {

#ifdef __linux__

int numberOf(const std::filesystem::path& name)
{
    const std::string text = name.filename().string();
    int number = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? number : -1;
}

/// What may be gone a moment later is passed over in silence.
template <typename Visit>
void forEachNumbered(const std::filesystem::path& folder, const Visit& visit)
{
    std::error_code gone;
    for (std::filesystem::directory_iterator it(folder, gone), end; !gone && it != end; it.increment(gone))
        if (const int number = numberOf(it->path()); number >= 0) visit(it->path(), number);
}

double stolenMs()
{
    std::ifstream file("/proc/stat");
    std::string processors;
    uint64_t user, nice, system, idle, waiting, interrupts, soft, stolen = 0;
    file >> processors >> user >> nice >> system >> idle >> waiting >> interrupts >> soft >> stolen;
    return file ? 1000.0 * double(stolen) / double(sysconf(_SC_CLK_TCK)) : 0.0;
}

#endif

} // namespace

double OtherWork::look()
{
    double ms = 0.0;
#ifdef __linux__
    std::unordered_map<int, uint64_t> ran;
    const int self = int(getpid());
    forEachNumbered("/proc", [&](const std::filesystem::path& process, int pid) {
        if (pid == self) return;
        forEachNumbered(process / "task", [&](const std::filesystem::path& thread, int tid) {
            uint64_t ns = 0;
            if (!(std::ifstream(thread / "schedstat") >> ns)) return;
            const auto before = ran_.find(tid);
            if (before != ran_.end() && ns > before->second) ms += double(ns - before->second) * 1e-6;
            if (before == ran_.end() && looked_) ms += double(ns) * 1e-6; // began since
            ran.emplace(tid, ns);
        });
    });
    ran_ = std::move(ran);
    const double stolen = stolenMs();
    if (looked_) ms += stolen - stolenMs_;
    stolenMs_ = stolen;
    looked_ = true;
#endif
    return ms;
}

} // namespace gnomon::demo
