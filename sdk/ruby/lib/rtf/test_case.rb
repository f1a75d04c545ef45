# frozen_string_literal: true

require "rtf/fault"
require "rtf/near"
require "rtf/plugin"

module RTF
  # A test: derive from it and write `run`, and `setup` and `tear_down` where
  # needed.
  #
  # The first failure or error decides the verdict. A failure means that the
  # robot is wrong, an error that the bench is; a problem in `setup` or in
  # `tear_down` is always an error.
  class TestCase < Plugin
    # What the violation of a monitor means.
    SEVERITIES = %w[fail error stop critical].freeze

    # Runs the test.
    def run
      raise NotImplementedError, "#{self.class} has no `run`"
    end

    # Runs the block as a case, a named result inside the test:
    # `self.case("joint 3", joint: 3) { … }`.
    #
    # An assertion, an error, an exception or `skip` ends the case, and the test continues
    # after it. The block does not run if the case is not selected.
    def case(name, **parameters, &block)
      Session.current.cases.run(name, parameters, &block)
    end

    # Announces the names of cases that the test is going to run.
    def plan_cases(names)
      Session.current.plan_cases(names)
    end

    # Ends the innermost case, otherwise the test, as skipped: the bench lacks something.
    def skip(reason)
      Session.current.skip(reason)
    end

    # Asks an operator, on the console, the page or the API, and returns the answer: one of
    # `choices`, or without them any line of text.
    #
    # If no operator answers within `timeout` seconds, or none can, it is `default`; without a
    # default, this is an error. `picture` is a PNG or JPEG file. The time limit of the test is
    # paused meanwhile.
    def ask(question, choices = [], timeout: Questions::ANSWER_SECONDS, default: nil, picture: nil)
      Session.current.ask(question, choices, timeout: timeout, default: default, picture: picture)
    end

    # Gives an operator an instruction, and waits until it is done. The answers are `done` and
    # `cannot`, which is an error; `default` is one of them, as in `ask`.
    def instruct(text, picture: nil, timeout: Questions::ANSWER_SECONDS, default: nil)
      answer = ask(text, %w[done cannot], timeout: timeout, default: default, picture: picture)
      error("the operator cannot do this: #{text}") unless answer == "done"
    end

    # Injects a fault of the suite that has no `at`, and returns it when it has begun: `remove`
    # removes it before the end of the test. With a block, it is removed at the end of the block.
    def fault(name)
      fault = Fault.new(Session.current, name)
      return fault unless block_given?

      begin
        yield fault
      ensure
        fault.remove
      end
    end

    # The test's values of a matrix.
    def parameters
      Session.current.task.parameters.dup
    end

    # The test's value of a matrix; an unknown name is an error.
    def parameter(name)
      session = Session.current
      problem = "there is no parameter \"#{name}\"; this test has"
      session.value_of(session.task.parameters, name, problem)
    end

    # Takes a sample of a signal; outside its limits it is a failure, and the test
    # continues. `time` is in seconds since the set-up began; the default is the current time.
    def sample(name, value, unit = "", time: nil, **limits)
      signal = Sampling::Signal.with(name, unit, **limits)
      time &&= Float(time)
      raise ArgumentError, "the time of `#{name}` is not finite" unless (time || 0).finite?

      Session.current.sampled(signal, Float(value), time)
    end

    # Judges the rest of the test by a formula over the signals of the suite. `severity` is
    # "fail", "error", "stop" or "critical"; the default name is the formula.
    def monitor(formula, name: nil, severity: "fail")
      unless SEVERITIES.include?(severity.to_s)
        known = SEVERITIES.join(", ")
        raise ArgumentError, "the severity of a monitor is one of #{known}, not `#{severity}`"
      end

      Session.current.monitor(name || formula, formula, severity.to_s)
    end

    # Samples the block's result at `rate` Hz; returns whether all are within the
    # limits. A slow block skips samples.
    def sample_for(name, seconds, rate, unit = "", **limits)
      raise ArgumentError, "the rate of `#{name}` is not above 0 Hz" unless rate.positive?

      watch = Clock::Stopwatch.new
      tick = 0
      good = true
      while tick < (seconds * rate) - 1e-9
        sleep([tick.fdiv(rate) - watch.passed, 0].max)
        good &= sample(name, yield, unit, **limits)
        # Each tick has a separate deadline, so that delays do not accumulate.
        tick = [tick + 1, (watch.passed * rate).ceil].max
      end
      sleep([seconds - watch.passed, 0].max)
      good
    end

    # Checks that a signal, as sampled so far, stays within `tolerance` of a stored trajectory: a
    # file below the directory of the suite, which `rtf golden accept` writes. `align` is "time"
    # or, for dynamic time warping by at most `band` seconds, "dtw". The runner compares: the test
    # continues, and a deviation is a failure.
    def check_trajectory(name, reference, tolerance, align: "time", band: nil)
      unless %w[time dtw].include?(align.to_s)
        raise ArgumentError, "`align` is \"#{align}\", expected \"time\" or \"dtw\""
      end

      params = { name: name.to_s, reference: reference.to_s, tolerance: Float(tolerance),
                 align: align.to_s, band: band && Float(band) }
      Session.current.check_trajectory(params)
    end

    # Checks that a picture, a PNG or JPEG file, differs by at most `tolerance` (1 minus the
    # structural similarity) from a stored one: a file below the directory of the suite, which
    # `rtf golden accept` writes. The runner compares a copy: the test continues, and a difference
    # is a failure.
    def check_picture(name, picture, reference, tolerance)
      full = File.expand_path(picture)
      Attachment.check(full)
      check = { reference: reference.to_s, tolerance: Float(tolerance),
                location: Location.caller_place }
      Session.current.attach(full, name.to_s, "", picture: check.compact)
    end

    # Checks that `condition` holds, and continues in either case.
    def check(condition, text)
      if condition
        Session.current.message("check", text)
      else
        Session.current.failure(text)
      end
      condition ? true : false
    end

    # Asserts that it is safe to continue: if not, the rest of the suite is skipped.
    def require_critical(condition, text)
      unless condition
        Session.current.failure(text, critical: true)
        raise CriticalAssertionEnded, text.to_s
      end
      Session.current.message("check", text)
    end

    # Checks that two numbers, vectors or matrices differ by at most `tolerance` anywhere.
    def check_near(got, expected, tolerance, what)
      send_comparison(Comparison.new(got, expected, tolerance), what)
    end

    # Asserts what `check_near` checks.
    def require_near(got, expected, tolerance, what)
      raise AssertionEnded, what.to_s unless check_near(got, expected, tolerance, what)
    end

    # Checks angles in radians: 3.1 and -3.1 are 0.083 apart.
    def check_angle_near(got, expected, tolerance, what)
      send_comparison(Comparison.new(got, expected, tolerance, angle: true), what)
    end

    # Asserts what `check_angle_near` checks.
    def require_angle_near(got, expected, tolerance, what)
      raise AssertionEnded, what.to_s unless check_angle_near(got, expected, tolerance, what)
    end

    private

    def send_comparison(comparison, what)
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
