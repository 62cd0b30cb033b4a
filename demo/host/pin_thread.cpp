#include "demo/host/pin_thread.hpp"

#ifdef __linux__
#include <sched.h>
#endif

namespace gnomon::demo {

void pinThread([[maybe_unused]] uint32_t index)
{
#ifdef __linux__
    static const cpu_set_t all = [] {
        cpu_set_t set;
        CPU_ZERO(&set);
        sched_getaffinity(0, sizeof set, &set);
        return set;
    }();
    const int count = CPU_COUNT(&all);
    if (count < 2) return;
    int left = int(index % uint32_t(count));
    for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
        if (!CPU_ISSET(processor, &all) || left-- > 0) continue;
        cpu_set_t own;
        CPU_ZERO(&own);
        CPU_SET(processor, &own);
        sched_setaffinity(0, sizeof own, &own);
        return;
    }
#endif
}

} // namespace gnomon::demo
