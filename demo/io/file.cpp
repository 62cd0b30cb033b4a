#include "demo/io/file.hpp"

#include <fstream>

namespace gnomon::demo {

Status writeFile(const std::filesystem::path& file, std::string_view bytes)
{
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close(); // what is still buffered may fail, too
    return out ? Status(Done{}) : Status::failure(file.string() + ": cannot be written");
}

} // namespace gnomon::demo
