# frozen_string_literal: true

require "rtf/session"
require "rtf/stop"

# What tests written for robot-testing-framework 2.x call. Such a test has it
# without a `require`, as it had there. The functions tell the runner about the
# test that runs.
module RobotTestingFramework
  module_function

  # Tells what the test calls itself; the name that the suite gives it stays.
  def setName(name)
    session = RTF::Session.current
    session.message("report", "test name: #{name}") unless name.to_s == session.task.name
  end

  # Tells the user something; it does not change the verdict.
  def testReport(text)
    RTF::Session.current.message("report", text)
    nil
  end

  # Checks that `condition` holds, and goes on either way.
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

  # Says that the robot is wrong, and ends this step.
  def assertFail(text)
    RTF::Session.current.failure(text)
    raise RTF::AssertionEnded, text.to_s
  end

  # Says that the bench is wrong, and ends this step.
  def assertError(text)
    RTF::Session.current.error(text)
    raise RTF::AssertionEnded, text.to_s
  end

  # The suite's environment string.
  def getEnvironment
    RTF::Session.current.task.environment
  end
end
