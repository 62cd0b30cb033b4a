#include "runtime/core/messages.hpp"

namespace gnomon {

void Messages::send(GnSeverity severity, GnResult result, const char* id, const std::string& text) const
{
    if (!callback_) return;
    const GnMessage message{severity, result, id, text.c_str()};
    callback_(&message, userData_);
}

} // namespace gnomon
