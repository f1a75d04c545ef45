// SPDX-License-Identifier: Apache-2.0
// The packets of session.hpp. C++11.
#ifndef RTF_INTERNAL_SESSIONREPORTS_HPP
#define RTF_INTERNAL_SESSIONREPORTS_HPP

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <rtf/internal/Location.hpp>
#include <rtf/internal/SessionChannel.hpp>
#include <rtf/internal/SessionJson.hpp>

namespace rtf {
namespace internal {
namespace session {

constexpr double no_low = -std::numeric_limits<double>::infinity();
constexpr double no_high = std::numeric_limits<double>::infinity();

struct Signal
{
    const std::string &name;
    const std::string &unit;
    double low;
    double high;
    Location here;
};

inline std::string packet(const std::string &method, const std::string &fields)
{
    return "{\"method\":\"" + method + "\",\"params\":{" + fields + "}}";
}

inline std::string location(const std::string &file, unsigned line)
{
    return "\"location\":{\"file\":" + json_string(file) + ",\"line\":" + std::to_string(line) +
           "}";
}

// Sends messages of a kind, several if the text is too long for one packet. `more` are
// further fields.
inline void message_with(const std::string &kind, const std::string &text, const std::string &more)
{
    // Leaves room for the fields.
    const std::size_t longest = longest_packet / 2;
    std::size_t at = 0;
    do {
        std::string json;
        while (at < text.size() && json.size() < longest) {
            json += json_character(text, at);
        }
        exchange(packet("message", "\"kind\":\"" + kind + "\",\"text\":\"" + json + "\"" + more));
    } while (at < text.size());
}

inline void message(const std::string &kind, const std::string &text, Location here)
{
    if (is_open()) {
        message_with(kind, text, "," + location(here.file, here.line));
    }
}

// Sends a packet; if that is impossible, reports an error.
inline bool send(const std::string &content, const std::string &name, Location here)
{
    if (content.size() > longest_packet) {
        message("error", "the report of `" + name.substr(0, 100) + "` is longer than 64 KiB", here);
        return false;
    }
    // The host reports why it does not accept a packet.
    return exchange(content) == "0";
}

// The fields of a signal and of a measurement.
inline std::string fields(const Signal &signal)
{
    std::string fields = "\"name\":" + json_string(signal.name);
    fields += ",\"unit\":" + json_string(signal.unit);
    fields += signal.low == no_low ? "" : ",\"low\":" + json_number(signal.low);
    fields += signal.high == no_high ? "" : ",\"high\":" + json_number(signal.high);
    return fields + "," + location(signal.here.file, signal.here.line);
}

// Whether both limits are numbers or absent. JSON has no others, and `null` is no limit.
inline bool has_valid_limits(const Signal &signal)
{
    const bool is_low = signal.low == no_low || json_number(signal.low) != "null";
    const bool is_high = signal.high == no_high || json_number(signal.high) != "null";
    if (!is_low || !is_high) {
        message("error", "a limit of `" + signal.name + "` is not a number", signal.here);
    }
    return is_low && is_high;
}

inline bool is_within(const Signal &signal, double value)
{
    return value > no_low && value < no_high && value >= signal.low && value <= signal.high;
}

inline bool measure(const Signal &signal, double value)
{
    if (!is_open()) {
        return is_within(signal, value);
    }
    if (!has_valid_limits(signal)) {
        return false;
    }
    const std::string value_field = ",\"value\":" + json_number(value);
    const bool is_sent =
        send(packet("measured", fields(signal) + value_field), signal.name, signal.here);
    return is_sent && is_within(signal, value);
}

inline bool sample(const Signal &signal, const std::vector<std::pair<double, double>> &points)
{
    // One point has at most 50 bytes.
    const std::size_t most = 512;
    bool is_good = !is_open() || has_valid_limits(signal);
    for (std::size_t first = 0; is_good && is_open() && first < points.size(); first += most) {
        std::string json;
        for (std::size_t at = first; at < points.size() && at < first + most; ++at) {
            json += (json.empty() ? "[" : ",[") + json_number(points[at].first) + "," +
                    json_number(points[at].second) + "]";
        }
        const std::string content = fields(signal) + ",\"points\":[" + json + "]";
        is_good = send(packet("sampled", content), signal.name, signal.here);
    }
    for (const std::pair<double, double> &point : points) {
        is_good = is_good && is_within(signal, point.second);
    }
    return is_good;
}

inline bool attach(const std::string &path, const std::string &name, const std::string &media_type,
                   Location here)
{
    char *const resolved = realpath(path.c_str(), nullptr);
    if (resolved == nullptr) {
        message("error", "there is no file `" + path + "` to attach", here);
        return false;
    }
    const std::string full = resolved;
    std::free(resolved);
    if (!is_open()) {
        return true;
    }
    const std::string shown = name.empty() ? path.substr(path.find_last_of('/') + 1) : name;
    std::string fields = "\"name\":" + json_string(shown);
    fields += ",\"path\":" + json_string(full);
    fields += ",\"media_type\":" + json_string(media_type);
    return send(packet("attached", fields), shown, here);
}

// The names and values of fixtures in a packet of the host, which is a list of objects.
inline std::vector<std::pair<std::string, std::string>> parse_values(const std::string &json)
{
    std::vector<std::pair<std::string, std::string>> values;
    JsonReader reader(json);
    reader.skip('[');
    while (reader.skip('{')) {
        std::pair<std::string, std::string> value;
        do {
            const std::string key = reader.value();
            reader.skip(':');
            const std::string text = reader.value();
            (key == "name" ? value.first : value.second) = text;
        } while (reader.skip(','));
        reader.skip('}');
        reader.skip(',');
        values.push_back(value);
    }
    return values;
}

inline std::string fixture_value(const std::string &name, const std::string &otherwise,
                                 Location here)
{
    if (Channel::instance().is_forked()) {
        message("error", "a forked process cannot read values of fixtures", here);
        return otherwise;
    }
    const std::string answer = is_open() ? exchange(packet("fixture-values", "")) : std::string();
    if (answer.empty()) {
        return otherwise;
    }
    std::string known;
    for (const std::pair<std::string, std::string> &value : parse_values(answer)) {
        if (value.first == name) {
            return value.second;
        }
        known += (known.empty() ? "" : ", ") + value.first;
    }
    message("error",
            "there is no fixture value \"" + name + "\"; there are " +
                (known.empty() ? "none" : known),
            here);
    return otherwise;
}

} // namespace session
} // namespace internal
} // namespace rtf

#endif
