# frozen_string_literal: true

require "rtf/stop"

module RTF
  # The state of one request of the runner.
  #
  # It exists from the moment the request is read, so that a stop request that arrives
  # before the plug-in is loaded is not lost.
  class RequestState
    # Longer waits are repeated: some clocks cannot take them.
    LONGEST_SECONDS = 3600
    private_constant :LONGEST_SECONDS

    attr_reader :stop_reason

    def initialize
      @lock = Mutex.new
      @changed = ConditionVariable.new
      @stop = false
      @stop_reason = ""
      @inside = nil
      @done = false
      @questions = {}
    end

    # Records a problem; only the first one counts. With a reason if no message reports it.
    def record(outcome, reason = nil)
      @lock.synchronize { @first = { outcome: outcome, reason: reason }.compact if @first.nil? }
    end

    # Records that the test skips itself; a problem has precedence.
    def skip(reason)
      answer = { outcome: "skipped", reason: reason }
      @lock.synchronize { @skipped = answer if @skipped.nil? }
    end

    # Whether there is no problem and no skip so far.
    def passed?
      @lock.synchronize { @first.nil? && @skipped.nil? }
    end

    # The answer to the request.
    def answer
      @lock.synchronize { @first || @skipped || { outcome: "passed" } }
    end

    # Asks the plug-in to stop; this is a problem.
    def request_stop(reason)
      record("interrupted", reason)
      @lock.synchronize do
        @stop_reason = reason
        @stop = true
        @changed.broadcast
      end
    end

    # Resets the request, so that a tear-down can wait until the runner asks again.
    def clear_stop
      @lock.synchronize { @stop = false }
    end

    def stop_requested?
      @stop
    end

    # The request is answered: nothing has to be stopped any more.
    def finish
      @lock.synchronize do
        @done = true
        @changed.broadcast
      end
    end

    # Waits for a stop request, for at most `seconds`.
    def wait_for_stop(seconds)
      wait(seconds) { @stop }
    end

    # Expects the end of a question.
    def open_question(number)
      @lock.synchronize { @questions[number] = nil }
    end

    # Records the answer to a question, or the problem that there is none.
    def close_question(number, answer:, problem:)
      @lock.synchronize do
        next unless @questions.key?(number)

        @questions[number] = { answer: answer, problem: problem }
        @changed.broadcast
      end
    end

    # Waits for the end of a question; nil after a stop request.
    def wait_for_answer(number)
      @lock.synchronize do
        @changed.wait(@lock, LONGEST_SECONDS) until @stop || @questions[number]
        @questions.delete(number)
      end
    end

    # Waits for the end of the request, for at most `seconds`.
    def wait_for_end(seconds)
      wait(seconds) { @done }
    end

    # Runs the plug-in's code in the calling thread. Only here can `stop` raise an exception.
    def enter_plugin(&block)
      Thread.handle_interrupt(Interrupted => :never) do
        @lock.synchronize { @inside = Thread.current }
        begin
          Thread.handle_interrupt(Interrupted => :immediate, &block)
        ensure
          @lock.synchronize { @inside = nil }
          discard_interrupt
        end
      end
    end

    # Ends the plug-in's code if it was asked to stop and still runs.
    def stop
      @lock.synchronize { @inside.raise(Interrupted, @stop_reason) if @inside && @stop }
    end

    private

    # Discards an exception that was raised as the plug-in's code returned.
    def discard_interrupt
      return unless Thread.pending_interrupt?(Interrupted)

      Thread.handle_interrupt(Interrupted => :immediate) { Thread.pass }
    rescue Interrupted
      # Expected.
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
