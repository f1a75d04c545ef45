# frozen_string_literal: true

require "rtf/location"
require "rtf/text"

module RTF
  # Batches of samples: a test may take thousands of samples per second.
  class Sampling
    # A batch of this size is sent.
    BATCH_SAMPLES = 256
    # A batch whose oldest sample has this age is sent with the next sample.
    BATCH_AGE_SECONDS = 0.1

    # A signal, and the limits of its samples.
    Signal = Struct.new(:name, :unit, :low, :high) do
      def self.with(name, unit, low: nil, high: nil)
        name, unit = [name, unit].map { |text| Text.utf8(text) }
        low, high = [low, high].map { |limit| limit && Float(limit) }
        if [low, high].compact.any?(&:nan?)
          raise ArgumentError, "a limit of `#{name}` is not a number"
        end

        new(name, unit, low, high)
      end

      # Whether a value is within the limits.
      def accept?(value)
        value.finite? && (low.nil? || value >= low) && (high.nil? || value <= high)
      end
    end

    # `notify` sends a notification to the runner.
    def initialize(&notify)
      @notify = notify
      @has_failed = false
      clear
    end

    # Starts the time of a test: its set-up begins.
    def begin
      @began = now
    end

    # Adds a sample, and sends the batches that are due. `source` is the signal and the
    # number of the case.
    def add(source, value, at, accepted:)
      taken = now
      at ||= @began ? (taken - @began).round(6) : 0.0
      # The first violation may decide the verdict: a crash must not lose it.
      first_failed = !accepted && !@has_failed
      @has_failed ||= first_failed
      safely do
        @oldest = taken if @batches.empty?
        points = points_of(*source)
        points << [at, value]
        full = points.length >= BATCH_SAMPLES || @batches.length >= BATCH_SAMPLES
        send_all if full || first_failed || taken - @oldest >= BATCH_AGE_SECONDS
      end
    end

    # Sends all batches if they would become too old in this time.
    def send_before(seconds)
      safely { send_all if @batches.any? && now - @oldest + seconds >= BATCH_AGE_SECONDS }
    end

    # Sends all batches.
    def send_pending
      safely { send_all } if @batches.any?
    end

    private

    def clear
      @process = Process.pid
      @lock = Mutex.new
      @batches = []
      # The batch for the next samples of a signal, by its name.
      @open = {}
    end

    # Without exceptions of other threads. A forked child forgets the samples of its
    # parent, which sends them itself.
    def safely(&block)
      Thread.handle_interrupt(Object => :never) do
        clear unless Process.pid == @process
        @lock.synchronize(&block)
      end
    end

    def points_of(signal, number)
      params, *source = @open[signal.name]
      return params[:points] if source == [signal, number]

      more = { case: number, location: Location.caller_place }
      params = signal.to_h.merge(more).compact.merge(points: [])
      @open[signal.name] = [params, signal, number]
      @batches << params
      params[:points]
    end

    def send_all
      @open.clear
      @notify.call("sampled", @batches.shift) until @batches.empty?
    end

    def now
      Process.clock_gettime(Process::CLOCK_MONOTONIC)
    end
  end
end
