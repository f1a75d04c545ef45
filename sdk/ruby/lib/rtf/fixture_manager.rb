# frozen_string_literal: true

require "rtf/plugin"

module RTF
  # A fixture: what has to run while tests do, such as a simulator or a driver.
  #
  # The runner calls `setup` before the tests, `check` before each test and
  # while tests run, and `tear_down` at the end, whatever happened.
  class FixtureManager < Plugin
    # Looks whether the fixture is well. False or an exception means that it collapsed.
    def check; end

    # Tells at once, from any thread, that the fixture is not well any more.
    def collapsed(reason)
      Session.current.notify("collapsed", { reason: Text.utf8(reason) })
    end
  end
end
