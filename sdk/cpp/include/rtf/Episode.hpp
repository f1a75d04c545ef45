// SPDX-License-Identifier: Apache-2.0
// An episode of a campaign that a test has started: see rtf/EpisodeTest.hpp.
#ifndef RTF_EPISODE_HPP
#define RTF_EPISODE_HPP

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <rtf/internal/Episodes.hpp>
#include <rtf/internal/Number.hpp>

namespace rtf {

// What a test knows about an episode at its end. What is missing is what Episode counted.
struct EpisodeEnd
{
    // How many steps it took.
    std::optional<std::uint64_t> steps = std::nullopt;
    // Its duration in simulated time.
    std::optional<std::chrono::duration<double>> time = std::nullopt;
    // At most 64 characters that are the same if the first observation is the same.
    std::string firstObservation = std::string();
};

// An object must not be used by two threads at the same time. Problems with the functions are
// errors that end the step, or the innermost case or episode.
class Episode
{
public:
    // EpisodeTest::take does this.
    Episode(const rtf_episode &taken, const rtf_slots &limits)
        : id_(taken.id), seed_(taken.seed), max_steps_(limits.max_steps), max_time_(limits.max_time)
    {
        for (std::size_t index = 0; index < taken.parameter_count; ++index) {
            const rtf_parameter &own = taken.parameters[index];
            parameters_.emplace(internal::from_text(own.name), internal::from_text(own.value));
        }
    }

    Episode(Episode &&) = default;
    Episode &operator=(Episode &&) = default;
    Episode(const Episode &) = delete;
    Episode &operator=(const Episode &) = delete;
    ~Episode() = default;

    // The number in the campaign, from 1.
    std::uint64_t id() const { return id_; }

    // For its random numbers: from 0 to 2³¹ − 1.
    std::uint32_t seed() const { return seed_; }

    // The parameters of the campaign, with their values as text.
    const std::map<std::string, std::string> &parameters() const { return parameters_; }

    // A parameter. An unknown name is an error.
    std::string parameter(std::string_view name, Location here = Location::current()) const
    {
        const auto own = parameters_.find(std::string(name));
        if (own != parameters_.end()) {
            return own->second;
        }
        std::string known;
        for (const auto &[known_name, value] : parameters_) {
            known += (known.empty() ? "" : ", ") + known_name;
        }
        internal::error(here, "there is no parameter \"" + std::string(name) + "\"; episode " +
                                  std::to_string(id_) + " has " + (known.empty() ? "none" : known));
    }

    // A parameter, or the default if there is none with this name.
    std::string parameter(std::string_view name, std::string_view otherwise) const
    {
        const auto own = parameters_.find(std::string(name));
        return own != parameters_.end() ? own->second : std::string(otherwise);
    }

    // Begins a step that takes `dt` of simulated time. False if it would exceed the limit in steps
    // or in simulated time: the step is not counted, and the result is `timed-out`. A stop request
    // ends the test.
    bool step(std::chrono::duration<double> dt = std::chrono::duration<double>::zero())
    {
        if (internal::host().interrupted(internal::host().context) != 0) {
            throw internal::Stop{true};
        }
        // Sums of times of steps are not exact; limits have microseconds.
        const bool no_time = max_time_ > 0 && (time_ + dt).count() > max_time_ + 0.5e-6;
        if (no_time || (max_steps_ > 0 && steps_ >= max_steps_)) {
            problem_ = no_time ? internal::number(max_time_) + " s of simulated time"
                               : std::to_string(max_steps_) + " steps";
            return false;
        }
        ++steps_;
        time_ += dt;
        return true;
    }

    // The first observation: a number, a text, or a range of these or of ranges, of which a hash
    // is stored. Further calls have no effect.
    template <class Values>
    void observe(const Values &values)
    {
        if (observation_.empty()) {
            internal::Hash hash;
            hash.add(values);
            observation_ = hash.text();
        }
    }

    // Finishes the episode, once. The problems that were reported in it decide as in a case, so
    // that `finish()` is enough after checks. `reason` is that of a failure. After a limit, it is
    // `timed-out`.
    void finish(bool passed = true, std::string_view reason = "", const EpisodeEnd &end = {},
                Location here = Location::current())
    {
        const std::string limit = "not done after " + problem_;
        const std::string &observed =
            end.firstObservation.empty() ? observation_ : end.firstObservation;
        auto result = internal::message_at<rtf_episode_end>(here);
        result.outcome = passed ? RTF_EPISODE_PASSED : RTF_EPISODE_FAILED;
        result.reason = internal::to_text(reason);
        if (!problem_.empty()) {
            result.outcome = RTF_EPISODE_TIMED_OUT;
            result.reason = internal::to_text(limit);
        }
        const auto steps = end.steps.value_or(steps_);
        result.steps = end.steps || steps_ > 0 ? static_cast<std::int64_t>(steps) : -1;
        result.time = end.time || time_.count() > 0 ? end.time.value_or(time_).count() : -1;
        result.first_observation = internal::to_text(observed);
        internal::finish_episode(here, id_, result);
        is_finished_ = true;
    }

    // A text would convert to true.
    void finish(const char *) = delete;

    bool finished() const { return is_finished_; }

    // Until the end of the scope, what this thread reports belongs to the episode.
    class Scope
    {
    public:
        explicit Scope(const Episode &episode, Location here = Location::current())
            : id_(episode.id_)
        {
            internal::enter_episode(here, id_);
        }

        ~Scope() { internal::leave_episode(id_); }

        Scope(const Scope &) = delete;
        Scope &operator=(const Scope &) = delete;

    private:
        std::uint64_t id_;
    };

    // Calls body() in such a scope. An assertion, an error, a skip or an exception in it finishes
    // this episode only; a critical assertion and a stop request end the test. Returns whether the
    // episode is still open.
    template <class Body>
    bool within(Body &&body, Location here = Location::current())
    {
        bool ends_test = false;
        {
            const Scope scope(*this, here);
            try {
                body();
            } catch (...) {
                ends_test = internal::report_exception();
                if (!is_finished_) {
                    finish(true, "", {}, here);
                }
            }
        }
        if (ends_test) {
            throw internal::Stop{true};
        }
        return !is_finished_;
    }

private:
    std::uint64_t id_;
    std::uint32_t seed_;
    std::map<std::string, std::string> parameters_;
    // The limits in steps and seconds; 0: none.
    std::uint64_t max_steps_;
    double max_time_;
    std::uint64_t steps_ = 0;
    std::chrono::duration<double> time_ = std::chrono::duration<double>::zero();
    // The limit that was reached; empty: none.
    std::string problem_;
    std::string observation_;
    bool is_finished_ = false;
};

} // namespace rtf

#endif
