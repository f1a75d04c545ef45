# frozen_string_literal: true

require "rtf/location"

module RTF
  # Samples of signals, which are sent in batches: a test may take thousands of
  # them in a second.
  class Sampling
    # A batch is sent when it has so many samples.
    COUNT = 256
    # A sample waits no longer for the next ones. Who takes no more and does
    # something else for long is behind by the last batch.
    AGE_SECONDS = 0.1

    # A signal, and the limits of its samples.
    Signal = Struct.new(:name, :unit, :low, :high) do
      def self.of(name, unit, low: nil, high: nil)
        low, high = [low, high].map { |limit| limit && Float(limit) }
        if [low, high].compact.any?(&:nan?)
          raise ArgumentError, "a limit of `#{name}` is not a number"
        end

        new(name, unit, low, high)
      end

      def hold?(value)
        value.finite? && (low.nil? || value >= low) && (high.nil? || value <= high)
      end
    end

    # `tell` sends a message to the runner.
    def initialize(&tell)
      @tell = tell
      @lock = Mutex.new
      @batches = []
      # The batch that takes the next samples of a signal, by its name.
      @open = {}
    end

    # Times count from now on: the test's set-up begins.
    def begin
      @began = now
    end

    # Keeps a sample, sends what is due, and returns the sample's time.
    def take(signal, value, at)
      taken = now
      at ||= @began ? (taken - @began).round(6) : 0.0
      safely do
        @since = taken if @batches.empty?
        points = points_of(signal)
        points << [at, value]
        full = points.length >= COUNT || @batches.length >= COUNT
        send_all if full || taken - @since >= AGE_SECONDS
      end
      at
    end

    # Sends all that would grow too old in this time.
    def send_before(seconds)
      safely { send_all if @batches.any? && now - @since + seconds >= AGE_SECONDS }
    end

    # Sends what there is.
    def send_pending
      safely { send_all } if @batches.any?
    end

    private

    # Whatever is raised into the thread meanwhile.
    def safely(&block)
      Thread.handle_interrupt(Object => :never) { @lock.synchronize(&block) }
    end

    def points_of(signal)
      params, of = @open[signal.name]
      return params[:points] if of == signal

      params = signal.to_h.merge(location: Location.caller_place).compact.merge(points: [])
      @open[signal.name] = [params, signal]
      @batches << params
      params[:points]
    end

    def send_all
      @open.clear
      @tell.call("sampled", @batches.shift) until @batches.empty?
    end

    def now
      Process.clock_gettime(Process::CLOCK_MONOTONIC)
    end
  end
end
