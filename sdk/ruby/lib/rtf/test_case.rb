# frozen_string_literal: true

require "rtf/keeper"
require "rtf/near"
require "rtf/plugin"

module RTF
  # A test: derive from it and write `run`, and `setup` and `tear_down` where
  # needed.
  #
  # The first failure or error decides the verdict. A failure says that the
  # robot is wrong, an error that the bench is; a problem in `setup` or in
  # `tear_down` is always an error.
  class TestCase < Plugin
    include Keeper

    # Does the test.
    def run
      raise NotImplementedError, "#{self.class} has no `run`"
    end

    # Checks that `condition` holds, and goes on either way.
    def check(condition, text)
      if condition
        Session.current.message("check", text)
      else
        Session.current.failure(text)
      end
      condition ? true : false
    end

    # Asserts something without which it is unsafe to go on: if it does not hold
    # this test ends, and the rest of the suite is skipped.
    def require_critical(condition, text)
      unless condition
        Session.current.failure(text, critical: true)
        raise AssertionEnded, text.to_s
      end
      Session.current.message("check", text)
    end

    # Checks that two numbers, vectors or matrices differ by at most `tolerance` anywhere.
    def check_near(got, expected, tolerance, what)
      tell(Comparison.new(got, expected, tolerance), what)
    end

    # Asserts what `check_near` checks.
    def require_near(got, expected, tolerance, what)
      raise AssertionEnded, what.to_s unless check_near(got, expected, tolerance, what)
    end

    # Checks angles in radians: 3.1 and -3.1 are 0.083 apart.
    def check_angle_near(got, expected, tolerance, what)
      tell(Comparison.new(got, expected, tolerance, angle: true), what)
    end

    # Asserts what `check_angle_near` checks.
    def require_angle_near(got, expected, tolerance, what)
      raise AssertionEnded, what.to_s unless check_angle_near(got, expected, tolerance, what)
    end

    private

    def tell(comparison, what)
      problem = comparison.problem
      numbers = comparison.to_h
      if problem
        Session.current.failure("#{what}: #{problem}", comparison: numbers)
      else
        Session.current.message("check", what, comparison: numbers)
      end
      problem.nil?
    end
  end
end
