#pragma once
// One line that says how far a long command is: rewritten in place on a terminal, a line per tenth elsewhere.

#include <cstdint>
#include <cstdio>
#include <string>

#include <unistd.h>

namespace gnomon::demo {

class Progress {
public:
    explicit Progress(uint32_t total) : total_(total), terminal_(isatty(STDERR_FILENO) == 1) {}

    void show(uint32_t done, const std::string& text)
    {
        const uint32_t tenth = total_ > 0 ? done * 10 / total_ : 10;
        if (terminal_)
            std::fprintf(stderr, "\r\033[K%u/%u  %s%s", done, total_, text.c_str(), done == total_ ? "\n" : "");
        else if (tenth != lastTenth_)
            std::fprintf(stderr, "%u/%u  %s\n", done, total_, text.c_str());
        lastTenth_ = tenth;
        std::fflush(stderr);
    }

private:
    uint32_t total_;
    uint32_t lastTenth_ = 0;
    bool terminal_;
};

} // namespace gnomon::demo
