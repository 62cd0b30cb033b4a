#include "runtime/select/fade.hpp"

#include <utility>

namespace gnomon {

Fade::Step Fade::advance(std::uint64_t frame, std::uint32_t method, std::uint32_t length, bool jump)
{
    before_ = now_;
    frame_ = frame;
    if (jump || length == 0 || method == kNone || now_.shown == kNone) {
        now_ = {.shown = method};
        return {};
    }
    const bool running = now_.outgoing != kNone;
    if (running && method == now_.outgoing) {
        std::swap(now_.outgoing, now_.shown);
        now_.step = now_.length + 1 - now_.step;
    } else if (method != now_.shown) {
        const bool outgoingPrevails = running && 2 * now_.step < now_.length + 1;
        now_ = {
            .outgoing = outgoingPrevails ? now_.outgoing : now_.shown, .shown = method, .step = 0, .length = length};
    }
    if (now_.outgoing == kNone) return {};
    if (++now_.step > now_.length) {
        skip();
        return {};
    }
    return {.outgoing = now_.outgoing,
            .share = static_cast<float>(now_.step) / static_cast<float>(now_.length + 1),
            .begun = running};
}

void Fade::withdraw(std::uint64_t frame)
{
    if (frame_ != frame) return;
    now_ = before_;
    frame_ = 0;
}

double admitFades(std::span<FadeRequest> requests, double plannedMs, double usableMs)
{
    for (const bool begun : {true, false}) {
        for (FadeRequest& request : requests) {
            if (request.begun != begun) continue;
            request.admitted = plannedMs + request.outgoingMs <= usableMs;
            if (request.admitted) plannedMs += request.outgoingMs;
        }
    }
    return plannedMs;
}

} // namespace gnomon
