with Ada.Environment_Variables;
with GNAT.Sockets; use GNAT.Sockets;

package body Arm is

   function Ask (Line : String) return String is
      Port   : constant String := Ada.Environment_Variables.Value ("RTF_FIXTURE_ARM_PORT");
      Socket : Socket_Type;
      Stream : Stream_Access;
      Answer : String (1 .. 1024);
      Last   : Natural := 0;
   begin
      Create_Socket (Socket);
      Connect_Socket
        (Socket,
         (Family => Family_Inet,
          Addr   => Inet_Addr ("127.0.0.1"),
          Port   => Port_Type'Value (Port)));
      Stream := GNAT.Sockets.Stream (Socket);
      String'Write (Stream, Line & ASCII.LF);
      loop
         Last := Last + 1;
         Character'Read (Stream, Answer (Last));
         exit when Answer (Last) = ASCII.LF;
      end loop;
      Close_Socket (Socket);
      if Last < 3 or else Answer (1 .. 2) /= "ok" then
         raise Refused with Line & ": " & Answer (1 .. Last - 1);
      end if;
      return (if Last > 4 then Answer (4 .. Last - 1) else "");
   end Ask;

end Arm;
