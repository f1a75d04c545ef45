# frozen_string_literal: true

module RTF
  module Host
    # YARP's network, for plug-ins that open ports without making a `Yarp::Network`.
    #
    # In robot-testing-framework 1.x and 2.x, a fixture in the same process had made one. There is
    # no link to YARP: its functions are looked up in the library that the plug-in has loaded.
    module YarpNetwork
      # In YARP 2, the last two letters of the library are capitals.
      LIBRARY = %r{/\S*/libYARP_(?:os|OS)\.so[.\d]*$}
      CLASS = "_ZN4yarp2os11NetworkBase"

      module_function

      # Initialises the network, if its library is loaded and the plug-in has not done so.
      def init
        path = File.read("/proc/self/maps")[LIBRARY]
        return unless path

        require "fiddle"
        library = Fiddle.dlopen(path)
        return if function(library, "11initializedEv", Fiddle::TYPE_CHAR).call.odd?

        function(library, "11initMinimumEv", Fiddle::TYPE_VOID).call
        @finish = function(library, "11finiMinimumEv", Fiddle::TYPE_VOID)
      rescue LoadError, Fiddle::DLError # no Fiddle, or not all functions of YARP
        nil
      end

      # Undoes the initialisation. A network that the plug-in has made itself stays.
      def finish
        @finish&.call
        @finish = nil
      end

      def function(library, name, type)
        Fiddle::Function.new(library[CLASS + name], [], type)
      end
    end
  end
end
