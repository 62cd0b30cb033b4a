#pragma once
// What methods share within a view (copies of its depth, receivers' bounds, a stencil buffer): what it takes, and which
// methods need it, as completed frames have shown.
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/cost/knowledge_base.hpp"
#include "runtime/plan/shared_part.hpp"
#include "runtime/select/facts.hpp"

namespace gnomon {

/// A frame's plan pays such work once, with the first light that needs it, and saves it with the last. Were it charged
/// to no light, a method would look affordable until it runs, then not, and be tried again once it has gone.
///
/// What no method has shown yet, nor a knowledge base told, counts as nothing: the first timed frame tells, and nothing
/// is forgotten.
class SharedParts {
public:
    SharedParts();

    /// What a knowledge base has measured on a device like this. What frames have shown here stays; methods that have
    /// come since the last call need what their algorithm does.
    /// @param algorithms Of every method, in their order.
    void teach(std::span<const cost::KnowledgePart> parts, std::span<const std::string_view> algorithms) noexcept;
    /// A pass of view scope of a timed frame; of several views, one after the other.
    /// @param pass    Name.
    /// @param methods Those that declared it.
    void note(const char* pass, const MethodSet& methods, float ms);
    /// @param ran    Methods that had passes in that frame. One that ran without a pass does not need it.
    /// @param pixels Of all views of that frame, > 0. Such work is done pixel by pixel.
    void endFrame(const MethodSet& ran, double pixels);
    /// For a frame with so many pixels; valid until the next call. Passes that the same methods need are one part.
    std::span<const plan::SharedPart> parts(double pixels);

private:
    struct Entry {
        std::uint64_t name = 0; ///< Hash of the text: a pass may come from a library that was loaded again.
        MethodSet methods;
        MedianOfFive msPerPixel;
        bool shown = false; ///< By a frame.
        // Of the frame that is being noted.
        MethodSet declarers;
        float ms = 0.0f;
    };
    Entry* entryOf(std::string_view pass);

    std::vector<Entry> entries_;
    std::size_t taught_ = 0; ///< Methods.
    std::array<plan::SharedPart, plan::kMaxParts> parts_{};
};

} // namespace gnomon
