// Catch2: the joints reach poses together.
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>

#include "arm.hpp"

TEST_CASE("elbow and wrist reach a pose", "[pose]")
{
    Arm arm;
    const double angle = GENERATE(-0.4, 0.0, 0.4);
    SECTION("elbow")
    {
        CHECK(arm.reaches("elbow", angle));
    }
    SECTION("wrist")
    {
        CHECK(arm.reaches("wrist", angle));
    }
    arm.move("elbow", 0.0);
    arm.move("wrist", 0.0);
}

TEST_CASE("the arm has three joints", "[fast]")
{
    REQUIRE(Arm().joints().size() == 3);
}
