# frozen_string_literal: true

module RTF
  # What ends a step of a plug-in early.
  #
  # These are no StandardErrors: a `rescue => error` around a robot's driver must
  # not swallow a failed assertion or a request to stop. Whoever rescues
  # Exception gains nothing either, since what went wrong first was recorded
  # before anything was raised.
  class StepEnded < Exception # rubocop:disable Lint/InheritException
  end

  # An assertion did not hold, or the plug-in said `fail` or `error`.
  class AssertionEnded < StepEnded
  end

  # The runner asked the plug-in to stop.
  class Interrupted < StepEnded
  end
end
