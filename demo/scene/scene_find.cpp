#include "demo/scene/scene_file.hpp"

#include <algorithm>
#include <cstdlib>

#include "rules/engine/diagnostic.hpp"

namespace gnomon::demo {
namespace {

namespace fs = std::filesystem;

/// Folders of shipped scenes, in the order they are asked. Only those that exist.
std::vector<fs::path> sceneFolders()
{
    std::vector<fs::path> folders;
    const char* data = std::getenv("GNOMON_DATA_DIR");
    if (data != nullptr && *data != '\0') folders.push_back(fs::path(data) / "demo" / "scenes");
    std::error_code error; // without /proc there is no executable to look beside
    const fs::path executable = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path beside = executable.parent_path();
        folders.push_back(beside / "scenes");
        folders.push_back(beside / ".." / "share" / "gnomon" / "scenes");
        folders.push_back(beside / ".." / ".." / "demo" / "scenes");
    }
    folders.emplace_back(GNOMON_SOURCE_SCENES);
    std::erase_if(folders, [](const fs::path& folder) {
        std::error_code ignored; // a folder that cannot be examined is skipped like a missing one
        return !fs::is_directory(folder, ignored);
    });
    return folders;
}

} // namespace

Outcome<fs::path> findScene(const std::string& nameOrPath)
{
    std::error_code ignored; // unreadable counts as absent; the message below names it
    if (fs::is_regular_file(nameOrPath, ignored)) return fs::path(nameOrPath);
    // "views/bench" is a name too; nothing with a dot is, so that no name leads out of the folder.
    const bool isName =
        !nameOrPath.empty() && nameOrPath[0] != '/' && nameOrPath.find_first_of("\\.") == std::string::npos;
    if (!isName) return Outcome<fs::path>::failure(nameOrPath + ": no such scene file");
    for (const fs::path& folder : sceneFolders()) {
        const fs::path file = folder / (nameOrPath + ".yaml");
        if (fs::is_regular_file(file, ignored)) return file.lexically_normal();
    }
    const std::vector<ShippedScene> shipped = shippedScenes();
    std::vector<std::string_view> known;
    for (const ShippedScene& scene : shipped)
        known.push_back(scene.name);
    return Outcome<fs::path>::failure("no scene named '" + nameOrPath + "'" +
                                      (known.empty() ? "; there are none" : rules::suggestion(nameOrPath, known)));
}

std::vector<ShippedScene> shippedScenes()
{
    std::vector<ShippedScene> scenes;
    for (const fs::path& folder : sceneFolders()) {
        std::error_code error; // a folder that vanishes meanwhile ends its loop
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
            if (entry->path().extension() != ".yaml") continue;
            const std::string name = entry->path().stem().string();
            const auto sameName = [&name](const ShippedScene& scene) { return scene.name == name; };
            if (std::none_of(scenes.begin(), scenes.end(), sameName))
                scenes.push_back({name, entry->path().lexically_normal()});
        }
    }
    std::sort(scenes.begin(), scenes.end(),
              [](const ShippedScene& a, const ShippedScene& b) { return a.name < b.name; });
    return scenes;
}

} // namespace gnomon::demo
