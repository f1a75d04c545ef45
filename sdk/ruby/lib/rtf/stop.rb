# frozen_string_literal: true

module RTF
  # Ends a step of a plug-in.
  #
  # No StandardError: a `rescue => error` around a robot's driver must not swallow a
  # failed assertion or a stop request. Rescuing Exception does not make a test pass:
  # the problem was recorded before the exception was raised.
  class StepEnded < Exception # rubocop:disable Lint/InheritException
  end

  # An assertion failed, or the plug-in called `fail` or `error`.
  class AssertionEnded < StepEnded
  end

  # A critical assertion failed. Ends the test, not only the case.
  class CriticalAssertionEnded < AssertionEnded
  end

  # The test or the case skips itself.
  class Skipped < StepEnded
  end

  # The runner asked the plug-in to stop.
  class Interrupted < StepEnded
  end
end
