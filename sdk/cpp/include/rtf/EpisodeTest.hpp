// SPDX-License-Identifier: Apache-2.0
// A test with slots, which runs many episodes of a campaign in one process: derive from
// rtf::EpisodeTest, and write RTF_PLUGIN(Class) once.
#ifndef RTF_EPISODETEST_HPP
#define RTF_EPISODETEST_HPP

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <rtf/Episode.hpp>
#include <rtf/TestCase.hpp>

namespace rtf {

class EpisodeTest : public TestCase
{
public:
    // Runs one episode after the other. Override it to run several at a time.
    void run() override
    {
        for (auto next = take(1); !next.empty(); next = take(1)) {
            Episode &started = next.front();
            if (started.within([&] { episode(started); })) {
                started.finish();
            }
        }
    }

protected:
    // Runs an episode. Its checks decide, or a call of finish(). What ends a case ends the
    // episode, and so does an exception.
    virtual void episode([[maybe_unused]] Episode &started)
    {
        RTF_ERROR("override `episode` or `run` of rtf::EpisodeTest");
    }

    // How many episodes may be open at the same time.
    std::size_t slots(Location here = Location::current()) const
    {
        return internal::episode_slots(here).slots;
    }

    // Starts up to `most` episodes (0: all) that have arrived, as many as there are free slots.
    // With `wait`, waits for at least one: an empty result means that none follows. Wait only if
    // no episode is open that this thread has to finish.
    std::vector<Episode> take(std::size_t most = 0, bool wait = true,
                              Location here = Location::current()) const
    {
        const rtf_slots limits = internal::episode_slots(here);
        std::vector<Episode> taken;
        rtf_episode next{};
        while ((most == 0 || taken.size() < most) &&
               internal::take_episode(here, wait && taken.empty(), next)) {
            taken.emplace_back(next, limits);
        }
        return taken;
    }
};

} // namespace rtf

#endif
