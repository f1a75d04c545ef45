# frozen_string_literal: true

require "rtf/location"
require "rtf/session"
require "rtf/stop"

module RTF
  module Host
    # The threads of the host and of the plug-in.
    module Threads
      OWN = :rtf_host
      private_constant :OWN

      # Reports exceptions that end a thread of the plug-in, unless the plug-in has disabled
      # Ruby's report with `report_on_exception`, to handle them itself.
      module Watched
        %i[new start fork].each do |name|
          define_method(name) do |*arguments, &block|
            super(*arguments, &Threads.watched(block))
          end
          ruby2_keywords(name)
        end
      end

      module_function

      # From now on, an exception that ends a thread of the plug-in is an error.
      def watch
        Thread.singleton_class.prepend(Watched)
      end

      # Starts a thread of the host.
      def start(name)
        thread = Thread.new do
          Thread.current[OWN] = true
          yield
        end
        thread.name = name
        # Runs also while the plug-in computes.
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
          Threads.report(problem)
          raise
        end
      end

      def report(problem)
        session = Session.running
        thread = Thread.current
        return if session.nil? || thread[OWN] || !thread.report_on_exception

        session.exception(problem)
      end

      # The stacks of all threads of the plug-in, the main one first.
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
