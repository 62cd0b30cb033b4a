#include "runtime/base/messages.hpp"

namespace gnomon {

void Messages::send(GnSeverity severity, GnResult result, const char* id, const std::string& text) const
{
    if (!callback_) return;
    const std::string whole = prefix_ + text;
    const GnMessage message{.severity = severity, .result = result, .pId = id, .pText = whole.c_str()};
    callback_(&message, userData_);
}

} // namespace gnomon
