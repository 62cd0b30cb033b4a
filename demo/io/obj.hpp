#pragma once

#include "demo/io/outcome.hpp"
#include "demo/scene/scene.hpp"

#include <filesystem>
#include <string>

namespace gnomon::demo {

/// Collects world-space triangles as Wavefront text: nine significant digits (a float survives the trip), LF, no
/// locale.
class ObjWriter {
public:
    /// Appends a group; positions are transformed in double.
    void add(const std::string& name, const Mesh& mesh, const Transform& transform);
    const std::string& text() const noexcept { return text_; }
    Status save(const std::filesystem::path& file) const;

private:
    std::string text_ = "# world space, metres\n";
    uint64_t vertexCount_ = 0;
};

} // namespace gnomon::demo
