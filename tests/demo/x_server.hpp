#pragma once
// Tests that need a display run once more under a virtual one.

#include <cstdlib>
#include <string>

#include <sys/wait.h>

namespace gnomon::demo {

inline bool canRun(const char* program)
{
    return std::system((std::string("command -v ") + program + " >/dev/null 2>&1").c_str()) == 0;
}

/// What the server that this runs under was started for; null: there is none.
inline const char* serverPurpose()
{
    return std::getenv("GNOMON_WINDOW_TEST");
}

/// The same program under a server with a screen like "1280x1024". \return its exit code; 77: no server can be started.
inline int runUnderServer(const std::string& screen, const std::string& purpose, int argc, char** argv)
{
    if (!canRun("xvfb-run") || !canRun("xauth")) return 77;
    std::string command = "GNOMON_WINDOW_TEST=" + purpose + " xvfb-run -a -s '-noreset -screen 0 " + screen +
                          "x24'"; // else it is away for a moment after its last client
    for (int i = 0; i < argc; ++i)
        command += std::string(" '") + argv[i] + "'";
    return WEXITSTATUS(std::system(command.c_str()));
}

} // namespace gnomon::demo
