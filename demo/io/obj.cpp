#include "demo/io/obj.hpp"

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"

namespace gnomon::demo {

void ObjWriter::add(const std::string& name, const Mesh& mesh, const Transform& transform)
{
    // Nine significant digits tell any two floats apart (std::numeric_limits<float>::max_digits10).
    constexpr int kDigits = 9;
    text_ += "o ";
    for (const char c : name) // a line break would end the line
        text_ += c == '\n' || c == '\r' ? ' ' : c;
    text_ += '\n';
    for (const glm::vec3& positionOs : mesh.positions) {
        const glm::dvec3 positionWs = transform.apply(positionOs);
        text_ += 'v';
        for (int axis = 0; axis < 3; ++axis) {
            text_ += ' ';
            appendDigits(text_, positionWs[axis], kDigits);
        }
        text_ += '\n';
    }
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        text_ += i % 3 == 0 ? "f " : " ";
        text_ += std::to_string(vertexCount_ + mesh.indices[transform.cornerOf(i)] + 1); // the format counts from one
        if (i % 3 == 2) text_ += '\n';
    }
    vertexCount_ += mesh.positions.size();
}

Status ObjWriter::save(const std::filesystem::path& file) const
{
    return writeFile(file, text_);
}

} // namespace gnomon::demo
