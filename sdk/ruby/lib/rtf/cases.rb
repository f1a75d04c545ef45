# frozen_string_literal: true

require "rtf/location"
require "rtf/stop"
require "rtf/text"

module RTF
  # The cases of a test: named results inside it.
  class Cases
    # A case that has started.
    OpenCase = Struct.new(:number, :path, :skip_reason)

    # A line of the protocol has a limit.
    NAMES_IN_LINE = 4096
    private_constant :NAMES_IN_LINE

    # Starts without cases, on the thread that runs the test.
    def initialize(session)
      @session = session
      @process = Process.pid
      @run_thread = Thread.current
      @count = 0
      # The open cases of each thread, the innermost last.
      @open = {}.compare_by_identity
      @lock = Mutex.new
      # After a stop request the runner finishes all cases that are open.
      @abandoned = false
    end

    # The innermost open case of this thread.
    def innermost
      @open[Thread.current]&.last
    end

    # The number of the case to which a message of this thread belongs.
    def current
      return if @count.zero?

      (innermost || @open[@run_thread]&.last)&.number
    end

    # Announces those of the cases that are selected.
    def plan(names)
      names = names.map { |name| Text.utf8(name) }.select { |name| @session.task.select?(name) }
      return if forked?

      names.each_slice(NAMES_IN_LINE) { |some| @session.notify("cases-planned", { names: some }) }
    end

    # Runs a case, if it is selected. Its end does not end the test, unless the process ends,
    # the runner has asked to stop, or a critical assertion failed.
    def run(name, parameters, &body)
      unless @session.phase == "run"
        @session.error("cases are allowed in `run` only")
        return
      end
      path = [innermost&.path, Text.utf8(name)].compact.join("/")
      return if stopped? || !@session.task.select?(path)

      Thread.handle_interrupt(Interrupted => :never) { run_selected(name, path, parameters, &body) }
      nil
    end

    # Whether this is a forked child: the runner accepts no cases and values from it.
    def forked?
      Process.pid != @process
    end

    private

    def run_selected(name, path, parameters, &body)
      opened = start(name, path, parameters)
      begin
        Thread.handle_interrupt(Interrupted => :immediate, &body)
      rescue Exception => problem # rubocop:disable Lint/RescueException
        raise if ends_test?(problem)

        @session.exception(problem) unless problem.is_a?(StepEnded)
      ensure
        # Also after `return`, `break` or `throw` in the body.
        @abandoned ||= stopped?
        close
        finish(opened) unless @abandoned || problem.is_a?(SystemExit)
      end
    end

    def start(name, path, parameters)
      stack = (@open[Thread.current] ||= [])
      return stack.push(OpenCase.new(current, path)).last if forked?

      params = { name: Text.utf8(name), parent: innermost&.number,
                 parameters: values(parameters), location: Location.caller_place }.compact
      # The runner expects the numbers in order.
      @lock.synchronize do
        @count += 1
        stack.push(OpenCase.new(@count, path))
        @session.notify("case-started", { case: @count, **params })
      end
      stack.last
    end

    def values(parameters)
      values = parameters.map { |name, value| { name: Text.utf8(name), value: Text.utf8(value) } }
      values unless values.empty?
    end

    def close
      stack = @open[Thread.current]
      stack.pop
      @open.delete(Thread.current) if stack.empty?
    end

    def finish(opened)
      return if forked?

      skipped = opened.skip_reason && { outcome: "skipped", reason: opened.skip_reason }
      @session.notify("case-finished", { case: opened.number, **skipped.to_h })
    end

    def ends_test?(problem)
      problem.is_a?(SystemExit) || problem.is_a?(CriticalAssertionEnded) || stopped?
    end

    # Whether the runner has stopped the test: it finishes the open cases.
    def stopped?
      @session.request.stop_requested?
    end
  end
end
