# frozen_string_literal: true

module RTF
  # The time for a plug-in: the simulator's, if its suite has a clock.
  module Clock
    # Names a file with the simulated time in seconds.
    VARIABLE = "RTF_CLOCK"
    private_constant :VARIABLE

    class << self
      # Whether the time is a simulator's.
      def simulated?
        !ENV.fetch(VARIABLE, "").empty?
      end

      # Seconds since an arbitrary time.
      def now
        @latest = read || @latest || 0.0
      end

      # The clock's time; nil while the file is being written.
      def read
        return Process.clock_gettime(Process::CLOCK_MONOTONIC) unless simulated?

        text = File.read(ENV.fetch(VARIABLE))
        Float(text) if text.end_with?("\n")
      rescue SystemCallError, ArgumentError
        nil
      end
    end

    # Measures the elapsed time, without jumps back.
    class Stopwatch
      def initialize
        @before = Clock.read
        @passed = 0.0
      end

      # Seconds since the stopwatch was created.
      def passed
        seconds = Clock.read
        return @passed unless seconds

        @passed += [0.0, seconds - @before].max if @before
        @before = seconds
        @passed
      end
    end
  end
end
