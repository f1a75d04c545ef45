# frozen_string_literal: true

require "rtf/location"
require "rtf/session"
require "rtf/stop"

module RTF
  module Host
    # The threads of the process: the host's own, and the plug-in's.
    module Threads
      OWN = :rtf_host
      private_constant :OWN

      # Notes what ends a plug-in's thread. Ruby prints of such threads that
      # they ended; who wants to deal with it elsewhere (by `join`) turns off
      # `report_on_exception`, and then it is not ours either.
      module Watched
        %i[new start fork].each do |name|
          define_method(name) do |*arguments, &block|
            super(*arguments, &Threads.watched(block))
          end
          ruby2_keywords(name)
        end
      end

      module_function

      # From now on an exception that ends a plug-in's thread is an error.
      def watch
        Thread.singleton_class.prepend(Watched)
      end

      # A thread of the host's own.
      def start(name)
        thread = Thread.new do
          Thread.current[OWN] = true
          yield
        end
        thread.name = name
        # Heard also while the plug-in computes.
        thread.priority = 3
        thread
      end

      def watched(block)
        return unless block

        proc do |*arguments, **options|
          block.call(*arguments, **options)
        rescue StepEnded, SystemExit
          raise
        rescue Exception => problem # rubocop:disable Lint/RescueException
          Threads.note(problem)
          raise
        end
      end

      def note(problem)
        session = Session.running
        thread = Thread.current
        return if session.nil? || thread[OWN] || !thread.report_on_exception

        Steps.record(session, problem)
      end

      # The stacks of all threads but the host's own, the main one first.
      def stacks(main)
        threads = Thread.list.reject { |thread| thread[OWN] }
        threads.sort_by { |thread| thread == main ? 0 : 1 }.map do |thread|
          name = thread == main ? "main thread" : "thread #{thread.name || thread.object_id}"
          lines = Location.backtrace(thread).map { |line| "  #{line}" }
          "#{name} (#{thread.status})\n#{lines.join("\n")}"
        end.join("\n\n")
      end
    end
  end
end
