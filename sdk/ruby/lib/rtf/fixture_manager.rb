# frozen_string_literal: true

require "rtf/json_value"
require "rtf/plugin"

module RTF
  # An attempt of a test.
  Test = Struct.new(:id, :name, :repetition, :attempt)

  # A fixture: it runs while tests run, for example a simulator or a driver.
  #
  # The runner calls `setup` before the tests, `check` before each test and
  # while tests run, and always `tear_down` at the end. A fixture with `test_started` or
  # `test_finished` is notified of each test.
  class FixtureManager < Plugin
    # Checks the fixture. False or an exception means that it collapsed.
    def check; end

    # Called before a test starts. False or an exception: the fixture collapsed.
    def test_started(_test); end

    # Called after a test with its verdict: `passed`, `failed`, `error`, `crashed`, …
    # Reports, measurements and attachments of this method belong to that test.
    def test_finished(_test, _verdict, _reason); end

    # Provides a value for tests, hooks and dependent fixtures: in `setup`, once per name.
    #
    # `value` is any value that `json` can encode, except nil. The others read it with
    # `fixture_value`, and from the environment.
    def provide(name, value)
      problem = value.nil? ? "nil" : JsonValue.problem(value)
      raise TypeError, "the value of `#{name}` is #{problem}" if problem

      Session.current.provide(Text.utf8(name), value)
    end

    # Reports from any thread that the fixture collapsed.
    def collapsed(reason)
      Session.current.notify("collapsed", { reason: Text.utf8(reason) })
    end
  end
end
