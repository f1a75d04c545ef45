# frozen_string_literal: true

require "rtf/keeper"
require "rtf/plugin"

module RTF
  # An attempt of a test, of which a fixture is told.
  Test = Struct.new(:id, :name, :repetition, :attempt)

  # A fixture: what has to run while tests do, such as a simulator or a driver.
  #
  # The runner calls `setup` before the tests, `check` before each test and
  # while tests run, and `tear_down` at the end, whatever happened. One that has a
  # `test_started` or a `test_finished` is told of each test.
  class FixtureManager < Plugin
    include Keeper

    # Looks whether the fixture is well. False or an exception means that it collapsed.
    def check; end

    # Hears that a test is about to begin. False or an exception: the fixture collapsed.
    def test_started(_test); end

    # Hears how a test was judged: `passed`, `failed`, `error`, `crashed`, … What the
    # fixture reports, measures and attaches here belongs to that test.
    def test_finished(_test, _verdict, _reason); end

    # Tells at once, from any thread, that the fixture is not well any more.
    def collapsed(reason)
      Session.current.notify("collapsed", { reason: Text.utf8(reason) })
    end
  end
end
