# frozen_string_literal: true

require "rtf/stop"

module RTF
  # What is known about one request of the runner: the first problem decides.
  #
  # It exists from the moment the request is read, so that a request to stop
  # which comes before the plug-in was loaded is not lost.
  class Judge
    # Nobody waits longer without looking again: more than some clocks can take.
    LONGEST_SECONDS = 3600
    private_constant :LONGEST_SECONDS

    # Only while `run` of a test is carried out does a failure speak against the
    # robot; everywhere else it speaks against the bench.
    attr_accessor :failures_are_errors
    attr_reader :stop_reason

    def initialize
      @failures_are_errors = true
      @lock = Mutex.new
      @changed = ConditionVariable.new
      @stop = false
      @stop_reason = ""
      @inside = nil
      @done = false
    end

    # Keeps the first problem; later ones are told but decide nothing.
    def note(outcome, reason)
      @lock.synchronize { @first = [outcome, reason] if @first.nil? }
    end

    def note_failure(reason)
      note(@failures_are_errors ? "error" : "failed", reason)
    end

    # Outcome and reason of the first problem.
    def first
      @lock.synchronize { @first }
    end

    # Asks the plug-in to stop; this counts as a problem.
    def request_stop(reason)
      note("interrupted", reason)
      @lock.synchronize do
        @stop_reason = reason
        @stop = true
        @changed.broadcast
      end
    end

    # Lets a tear-down sleep and wait again, until the runner asks once more.
    def clear_stop
      @lock.synchronize { @stop = false }
    end

    def stop_requested?
      @stop
    end

    # The request is answered: nobody has to be stopped any more.
    def finish
      @lock.synchronize do
        @done = true
        @changed.broadcast
      end
    end

    # Waits for a request to stop, but not longer than `seconds`.
    def wait_for_stop(seconds)
      wait(seconds) { @stop }
    end

    # Waits for the end of the request, but not longer than `seconds`.
    def wait_for_end(seconds)
      wait(seconds) { @done }
    end

    # Lets the calling thread carry out the plug-in's code, which `insist` may
    # end. Outside of it a late insistence hurts nobody.
    def enter_plugin(&block)
      Thread.handle_interrupt(Interrupted => :never) do
        @lock.synchronize { @inside = Thread.current }
        begin
          Thread.handle_interrupt(Interrupted => :immediate, &block)
        ensure
          @lock.synchronize { @inside = nil }
          forget_insistence
        end
      end
    end

    # Ends the plug-in's code if it was asked to stop and still runs.
    def insist
      @lock.synchronize { @inside.raise(Interrupted, @stop_reason) if @inside && @stop }
    end

    private

    # One that was raised while the plug-in's code was being left.
    def forget_insistence
      return unless Thread.pending_interrupt?(Interrupted)

      Thread.handle_interrupt(Interrupted => :immediate) { Thread.pass }
    rescue Interrupted
      # That is what it was waited for.
    end

    def wait(seconds)
      deadline = now + seconds
      @lock.synchronize do
        until yield
          left = deadline - now
          return false if left <= 0

          @changed.wait(@lock, [left, LONGEST_SECONDS].min)
        end
      end
      true
    end

    def now
      Process.clock_gettime(Process::CLOCK_MONOTONIC)
    end
  end
end
