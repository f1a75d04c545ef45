# frozen_string_literal: true

require "rtf/clock"
require "rtf/session"
require "rtf/stop"
require "rtf/text"

module RTF
  # What tests and fixtures have in common.
  class Plugin
    POLL_SECONDS = 0.01
    private_constant :POLL_SECONDS

    @derived = []

    class << self
      # The classes that derive from ours, each with the file that says so.
      def derived
        Plugin.instance_variable_get(:@derived)
      end

      def inherited(other)
        super
        place = caller_locations(1).find { |frame| Location.foreign?(frame) }
        derived << [other, place&.path]
      end
    end

    # The name under which the suite knows this plug-in.
    def name
      Session.current.task.name
    end

    # The parameter string as it stands in the suite.
    def param
      Session.current.task.param
    end

    # The suite's environment string.
    def environment
      Session.current.task.environment
    end

    # The repetition that runs, from 1.
    def repetition
      Session.current.task.repetition
    end

    # Tells the user something; it does not change the verdict.
    def report(text)
      Session.current.message("report", text)
    end

    # Says that the robot is wrong, and ends this step. With a class or an
    # exception it is Ruby's own `fail`.
    def fail(text = nil, *more, **options)
      ruby = text.nil? || text.is_a?(Exception) || text.is_a?(Class) || more.any?
      Kernel.raise(*[text, *more].compact, **options) if ruby
      Session.current.failure(text)
      Kernel.raise AssertionEnded, text.to_s
    end

    # Says that the bench is wrong (no network, no calibration file), and ends this step.
    def error(text)
      Session.current.error(text)
      raise AssertionEnded, text.to_s
    end

    # Asserts that `condition` holds; if it does not, this step ends. With one
    # argument it is Ruby's own `require`.
    def require(condition, *text)
      return super(condition) if text.empty?

      fail(text.first.to_s) unless condition

      Session.current.message("check", text.first)
    end

    # Seconds since a moment that does not matter, by the clock that the suite has.
    def now
      Clock.now
    end

    # Sleeps, but wakes at once when the runner asks to stop; then this step ends.
    # In a test of a suite with a clock these are seconds of simulated time.
    def sleep(seconds = Float::MAX)
      return pause(seconds) unless Clock.simulated?

      Session.current.sampling.send_before(seconds)
      watch = Clock::Stopwatch.new
      while (left = seconds - watch.passed).positive?
        pause([POLL_SECONDS, left].min)
      end
      pause(0)
    end

    # Waits until the block is true, asking every 10 ms for `timeout` seconds.
    #
    # When the time is over this is a failed assertion, which tells `what` was
    # waited for and the last value. The time is the one of `now`.
    def wait_until(timeout, what)
      watch = Clock::Stopwatch.new
      loop do
        value = yield
        return true if value

        left = timeout - watch.passed
        if left <= 0
          whose = " of simulated time" if Clock.simulated?
          fail("#{what}: not within #{Text.number(timeout.to_f)} s#{whose} " \
               "(last value: #{Text.value(value)})")
        end
        pause([POLL_SECONDS, left].min)
      end
    end

    # Whether the runner has asked to stop; a loop that runs long should look at it.
    def interrupted?
      Session.current.judge.stop_requested?
    end

    # Prepares the plug-in. False or an exception means that this failed.
    def setup(_args); end

    # Puts back what the plug-in changed. Called whatever happened before. Those
    # who write it as the other languages do get the same.
    def tear_down
      tearDown if respond_to?(:tearDown, true)
    end

    private

    # Sleeps by the wall clock.
    def pause(seconds)
      session = Session.current
      session.sampling.send_before(seconds)
      judge = session.judge
      raise Interrupted, judge.stop_reason if judge.wait_for_stop(seconds)
    end
  end
end
