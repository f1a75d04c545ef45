# frozen_string_literal: true

require "rtf/host/load"
require "rtf/session"

module RTF
  module Host
    # Carries out the steps of a plug-in: set-up, run, check, tear-down.
    module Steps
      module_function

      # Loads a test, sets it up, runs it and tears it down.
      def run_test(session)
        test = load(session, TestCase)
        if test
          phase(session, "setup")
          session.sampling.begin
          if step(session, "setup") { test.setup(session.task.args) }
            phase(session, "run")
            session.judge.failures_are_errors = false
            step(session, "run") { test.run }
            session.judge.failures_are_errors = true
          end
          phase(session, "tear-down")
          tear_down(session, test)
        end
        answer(session)
      end

      # Loads a fixture and sets it up. It is returned if it was loaded, well or not.
      def set_up_fixture(session, present)
        if present
          session.judge.note("error", "a fixture is still set up in this host")
          return [present, answer(session)]
        end
        fixture = load(session, FixtureManager)
        step(session, "setup") { fixture.setup(session.task.args) } if fixture
        answer = answer(session)
        notices = fixture && answer[:outcome] == "passed" ? notices(fixture) : []
        answer[:subscriptions] = notices if notices.any?
        [fixture, answer]
      end

      # What a fixture wants to be told of tests: that for which it has a method.
      def notices(fixture)
        own = ->(name) { fixture.method(name).owner != FixtureManager }
        [*("test-started" if own[:test_started]), *("test-finished" if own[:test_finished])]
      end

      # Tells a fixture that a test is about to begin, or how it was judged.
      def tell_fixture(session, fixture, method, params)
        session.judge.failures_are_errors = false
        test = Test.new(*(params["test"] || {}).values_at("id", "name", "repetition", "attempt"))
        if fixture.nil?
          session.judge.note("error", "no fixture is set up")
        elsif method == "test-started"
          step(session, "test_started") { fixture.test_started(test) }
        else
          ending = [params["verdict"], params["reason"].to_s]
          step(session, "test_finished") { fixture.test_finished(test, *ending) }
        end
        answer(session)
      end

      # Asks a fixture whether it is well.
      def check_fixture(session, fixture)
        session.judge.failures_are_errors = false
        if fixture
          step(session, "check") { fixture.check }
        else
          session.judge.note("error", "no fixture is set up")
        end
        answer(session)
      end

      # Tears a fixture down. One that could not be loaded has nothing to tear down.
      def tear_down_fixture(session, fixture)
        tear_down(session, fixture) if fixture
        answer(session)
      end

      # Makes an error of an exception, with its class, its text and where it came from.
      def record(session, problem)
        reason = "#{problem.class}: #{Text.utf8(problem.message)}"
        place = Location.of_exception(problem, session.task.file)
        lines = Location.backtrace(problem).map { |line| "  from #{Text.utf8(line)}" }
        session.error(reason, text: [reason, *lines].join("\n"), location: place)
      end

      def phase(session, name)
        session.notify("phase", { phase: name })
      end

      def load(session, base)
        guard(session) { Load.load(session.task.file, base) }
      end

      # Carries out a step and looks at what it returns; whether all is well so far.
      def step(session, what, &block)
        result = guard(session, &block)
        session.judge.note_failure("#{what} returned false") if result == false && what != "run"
        session.judge.first.nil?
      end

      def tear_down(session, plugin)
        session.judge.clear_stop
        guard(session) { plugin.tear_down }
      end

      # Calls into the plug-in and records what it raises. Only SystemExit gets
      # through: the plug-in ends its process, and the runner shall see that.
      def guard(session, &block)
        process = Process.pid
        result = call(session, &block)
        return result if Process.pid == process

        # A forked child came back from the plug-in; its parent serves the runner.
        flush_output
        session.sampling.send_pending
        exit!(0)
      end

      def call(session, &block)
        session.judge.enter_plugin(&block)
      rescue SystemExit
        raise
      rescue StepEnded
        nil # recorded before it was raised
      rescue LoadError => problem
        problem.is_a?(Load::NoPlugin) ? session.error(problem.message) : record(session, problem)
        nil
      rescue Exception => problem # rubocop:disable Lint/RescueException
        record(session, problem)
        nil
      end

      def flush_output
        [$stdout, $stderr].each(&:flush)
      end

      def answer(session)
        flush_output
        session.sampling.send_pending
        outcome, reason = session.judge.first
        outcome ? { outcome: outcome, reason: reason } : { outcome: "passed" }
      end
    end
  end
end
