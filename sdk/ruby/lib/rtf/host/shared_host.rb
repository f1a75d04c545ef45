# frozen_string_literal: true

module RTF
  module Host
    # Separates the output and the processes of one test from those of the next: see "Shared
    # hosts" in spec/protocol.md.
    class SharedHost
      # `prctl`'s number for: orphans below this process become its children.
      SET_CHILD_SUBREAPER = 36
      private_constant :SET_CHILD_SUBREAPER

      # Prepares for several tests; nil if this interpreter does not support it. Leftover
      # processes of a test become children of this process, not of the runner.
      def self.begin
        require "fiddle" # not every interpreter has it
        number = Fiddle::TYPE_LONG
        prctl = Fiddle::Function.new(Fiddle::Handle::DEFAULT["prctl"],
                                     [Fiddle::TYPE_INT, *([number] * 4)], Fiddle::TYPE_INT)
        return unless prctl.call(SET_CHILD_SUBREAPER, 1, 0, 0, 0).zero?

        new([1, 2].map { |descriptor| IO.for_fd(descriptor, autoclose: false).dup })
      rescue LoadError, SystemCallError, Fiddle::DLError
        nil
      end

      # Takes copies of the runner's outputs: a plug-in may redirect its own.
      def initialize(outputs)
        @outputs = outputs.each do |output|
          output.binmode
          output.sync = true
        end
      end

      # Whether the next test may begin; if so, ends the present test's output.
      def end_test(end_marker)
        return false if children?

        @outputs.each { |output| output.write(end_marker) }
        true
      rescue SystemCallError
        false
      end

      private

      # Whether the test left processes behind. Reaps those that have ended.
      def children?
        nil while Process.wait(-1, Process::WNOHANG)
        true
      rescue Errno::ECHILD
        false
      end
    end
  end
end
