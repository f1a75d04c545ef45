// SPDX-License-Identifier: Apache-2.0
// Parses a line of JSON from the runner.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_JSONFIELDS_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_JSONFIELDS_H

#include <map>
#include <string>

#include <rtf/internal/SessionJson.hpp>

namespace robottestingframework {
namespace internal {

// The values of a JSON object by their paths: `message.location.line`. Expects valid JSON without
// blanks.
class JsonFields
{
public:
    explicit JsonFields(const std::string &line)
    {
        Reader reader(line);
        read(reader, std::string());
    }

    // Empty if there is no such field.
    const std::string &operator[](const std::string &path) { return fields_[path]; }

private:
    using Reader = ::rtf::internal::session::JsonReader;

    // Reads the value at this path.
    void read(Reader &reader, const std::string &path)
    {
        if (!reader.skip('{')) {
            fields_[path] = reader.value();
            return;
        }
        do {
            const std::string name = reader.value();
            reader.skip(':');
            read(reader, path.empty() ? name : path + "." + name);
        } while (reader.skip(','));
        reader.skip('}');
    }

    std::map<std::string, std::string> fields_;
};

} // namespace internal
} // namespace robottestingframework

#endif
