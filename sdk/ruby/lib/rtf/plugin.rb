# frozen_string_literal: true

require "rtf/attachment"
require "rtf/clock"
require "rtf/sampling"
require "rtf/session"
require "rtf/stop"
require "rtf/text"

module RTF
  # The base class of tests and fixtures.
  class Plugin
    POLL_SECONDS = 0.01
    private_constant :POLL_SECONDS

    @derived = []

    class << self
      # All derived classes, each with its file.
      def derived
        Plugin.instance_variable_get(:@derived)
      end

      def inherited(other)
        super
        place = caller_locations(1).find { |frame| Location.foreign?(frame) }
        derived << [other, place&.path]
      end
    end

    # The plug-in's name in the suite.
    def name
      Session.current.task.name
    end

    # The plug-in's parameter string in the suite.
    def param
      Session.current.task.param
    end

    # The suite's environment string.
    def environment
      Session.current.task.environment
    end

    # The present repetition, from 1.
    def repetition
      Session.current.task.repetition
    end

    # A value that a fixture provided: `simulator.port`; an unknown name is an error. Tests and
    # hooks can read the values of all fixtures of their suite, a fixture those of the fixtures
    # that it depends on.
    def fixture_value(name)
      session = Session.current
      problem = "there is no fixture value \"#{name}\"; there are"
      session.value_of(session.task.fixture_values, name, problem)
    end

    # Reports information; it does not change the verdict.
    def report(text)
      Session.current.message("report", text)
    end

    # Reports a failure (the robot is wrong) and ends this step. With a class or an
    # exception it is Ruby's own `fail`.
    def fail(text = nil, *more, **options)
      ruby = text.nil? || text.is_a?(Exception) || text.is_a?(Class) || more.any?
      Kernel.raise(*[text, *more].compact, **options) if ruby
      Session.current.failure(text)
      Kernel.raise AssertionEnded, text.to_s
    end

    # Reports an error (the bench is wrong (no network, no calibration file), and ends this step.
    def error(text)
      Session.current.end_with_error(text)
    end

    # Asserts that `condition` holds; if it does not, this step ends. With one
    # argument it is Ruby's own `require`.
    def require(condition, *text)
      return super(condition) if text.empty?

      fail(text.first.to_s) unless condition

      Session.current.message("check", text.first)
    end

    # Seconds since an arbitrary time, by the suite's clock.
    def now
      Clock.now
    end

    # Sleeps by the suite's clock. A stop request ends the sleep and this step.
    def sleep(seconds = Float::MAX)
      return pause(seconds) unless Clock.simulated?

      Session.current.sampling.send_before(seconds)
      watch = Clock::Stopwatch.new
      while (left = seconds - watch.passed).positive?
        pause([POLL_SECONDS, left].min)
      end
      pause(0)
    end

    # Waits until the block is true, polling every 10 ms for `timeout` seconds.
    #
    # After the timeout, the assertion fails with `what` and the last value. The time is
    # that of `now`.
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

    # Whether the runner has asked to stop; long loops should poll this.
    def interrupted?
      Session.current.request.stop_requested?
    end

    # Prepares the plug-in. False or an exception means that this failed.
    def setup(_args); end

    # Restores the initial state. Always called. The spelling of the other languages works,
    # too.
    def tear_down
      tearDown if respond_to?(:tearDown, true)
    end

    # Records a number; outside its limits it is a failure. A value that is not a finite
    # number is outside any limits. A fixture measures in its `test_finished`.
    def measure(name, value, unit = "", low: nil, high: nil)
      signal = Sampling::Signal.with(name, unit, low: low, high: high)
      Session.current.measured(signal, Float(value))
    end

    # Adds a copy of a complete file to the results.
    def attach(path, name: nil, media_type: nil)
      full = File.expand_path(path)
      Attachment.check(full)
      Session.current.attach(full, name || File.basename(full), media_type)
    end

    private

    # Sleeps by the wall clock.
    def pause(seconds)
      session = Session.current
      session.sampling.send_before(seconds)
      request = session.request
      raise Interrupted, request.stop_reason if request.wait_for_stop(seconds)
    end
  end
end
