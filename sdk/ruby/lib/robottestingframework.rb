# frozen_string_literal: true

require "rtf/session"
require "rtf/stop"

# The functions for tests that were written for robot-testing-framework 2.x. As there, such a
# test has the module without a `require`.
module RobotTestingFramework
  module_function

  # Reports the test's own name; its name in the suite does not change.
  def setName(name)
    session = RTF::Session.current
    session.message("report", "test name: #{name}") unless name.to_s == session.task.name
  end

  # Reports information; it does not change the verdict.
  def testReport(text)
    RTF::Session.current.message("report", text)
    nil
  end

  # Checks that `condition` holds, and continues in either case.
  def testCheck(condition, text)
    session = RTF::Session.current
    condition ? session.message("check", text) : session.failure(text)
    nil
  end

  # Fails *unless* `condition` holds, which is the predecessor's sense of it.
  def testFailIf(condition, text)
    RTF::Session.current.failure(text) unless condition
    nil
  end

  # Reports a failure (the robot is wrong) and ends this step.
  def assertFail(text)
    RTF::Session.current.failure(text)
    raise RTF::AssertionEnded, text.to_s
  end

  # Reports an error (the bench is wrong) and ends this step.
  def assertError(text)
    RTF::Session.current.end_with_error(text)
  end

  # The suite's environment string.
  def getEnvironment
    RTF::Session.current.task.environment
  end
end
